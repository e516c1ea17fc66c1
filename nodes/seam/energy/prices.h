#pragma once

#include "nodes/seam/energy/volume.h"

namespace fluidcarve {

/// What a sequence is like where there is something to see: the unit in which rigidity, edges and empty space are weighed, so that the
/// same weights serve any energy, field and resolution (METHOD 10).
struct Typical {
    double energy = 1;   ///< mean energy of the vertices with content
    double edge = 1;     ///< mean edge of the field there: by how much it differs from the vertex before to the one behind
    float content = -1;  ///< a vertex has content where the field's size is above this

    /// With a field, content is where its size is above `content_share` of its greatest; without one, where the energy is above 0.
    /// Marked vertices do not count.
    /// @throws Failure if the field is the same at all vertices
    static Typical of(const EnergyVolume& energy);
    static constexpr float content_share = 0.02f;
};

/// What seams pay beside the energy, in typical units.
struct Prices {
    float edges = 1;                  ///< for a typical edge
    float empty = 1;                  ///< for a vertex without content, as a share of the mean price of those with content
    std::array<float, 2> rigidity{};  ///< for a step, in space and in time
};

/// Sets what seams pay. Where there is a field, each vertex costs a typical energy more, so that seams also spread where the energy is 0; and
/// vertices without content cost so much more that their price comes to Prices::empty.
void set_prices(EnergyVolume& energy, const Typical& typical, const Prices& prices);

}  // namespace fluidcarve
