#pragma once

#include "carve/base/limits.h"
#include "carve/field/shown_part.h"
#include "carve/solver/costs/energy_volume.h"

#include <array>

namespace fluidcarve {

/// Typical values of a sequence's content. They are the units of rigidity, edges and empty space,
/// so that the same weights serve any energy, field and resolution (METHOD 10).
struct Typical {
    double energy = 1;  ///< mean energy of the vertices with content
    double edge = 1;  ///< mean edge of the field there: the difference between the vertices before
                      ///< and behind along the axis
    float content = -1;  ///< a vertex has content if the field's absolute value is above this

    /// Measures a volume. With a field, content is where its absolute value exceeds `content_share`
    /// of its maximum; without one, where the energy is above 0. Marked vertices do not count.
    /// @throws Failure if the field is the same at all vertices
    static Typical of(const EnergyVolume& energy);
    static constexpr float content_share = ShownPart::share;
};

/// What seams pay besides the energy, in typical units.
struct Prices {
    float edges = 1;  ///< for an edge of typical size
    /// For a vertex without content, as a share of the mean price of vertices with content.
    float empty = 1;
    std::array<float, 2> rigidity{};  ///< for a step, in space and in time
    bool free_in_nothing = false;     ///< as in StepPrices
};

/// Adds what seams pay to sampled energies, and counts the edges of their field. With a field, each
/// vertex with content costs a typical energy more, so that seams also spread where there is no
/// energy. A vertex without content costs so much more that its price becomes Prices::empty.
/// @param limits  as for EnergyVolume::count_edges()
/// @throws Failure as FrameStore
void add_prices(EnergyVolume& energy, const Typical& typical, const Prices& prices,
                const Limits& limits);

}  // namespace fluidcarve
