#pragma once

#include "carve/solver/costs/energy_volume.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace fluidcarve {

/// Weights of the prices of slabs (METHOD 8 "Thick seams").
struct SlabWeights {
    /// Weight of the difference between both sides of a slab; its energy has the weight 1.
    float join = 1;
    std::optional<float> empty;  ///< price of a slab without content, in mean prices of content;
                                 ///< nothing: found by SlabPrices::emptiness
    /// Cost of a step, in space and in time, in mean prices of content.
    std::array<float, 2> rigidity{};
};

/// Seams that are slabs of several vertices.
struct Thick {
    int thickness;  ///< of a slab, entries of the energy
    SlabWeights weights;
};

/// Prices of slabs: of taking out `thickness` vertices of a column at once, or doubling them. A
/// slab is cheap where what lies before it matches what lies behind it, where it holds little
/// energy, and where it holds no outline. Slabs without content have a price of their own. Prices
/// are in units of the whole sequence, so that the same weights serve any energy, field and
/// resolution.
class SlabPrices {
public:
    /// Measures a sequence.
    /// @param volume     energies without prices and edges, and a field
    /// @param thickness  of most slabs, vertices; at most the volume's width
    /// @throws Failure if the field is 0 at all vertices
    SlabPrices(const EnergyVolume& volume, int thickness, const SlabWeights& weights);

    /// A slab that was taken. Other slabs keep away from it, so that each part of the content
    /// gives its share.
    struct Taken {
        SeamEntries at;  ///< in each column: the first entry of a slab that is doubled, or the
                         ///< entry that now stands where a slab was
        int thickness;   ///< its present thickness: 0 if it was removed
    };
    /// The prices as a volume of their own: entry `i` of a column is the price of the slab of
    /// entries `i` to `i + thickness - 1`. A slab is protected if one of its entries is, or
    /// attracted.
    /// @param empty          price of a slab without content, in mean prices of content
    /// @param volume         the measured one, perhaps with slabs removed since; must outlive the
    ///   prices
    /// @param taken          slabs from which the next one keeps away
    /// @param limits         as for EnergyVolume
    EnergyVolume priced(const EnergyVolume& volume, int thickness, float empty,
                        std::span<const Taken> taken, const Limits& limits) const;
    /// Sets the prices of slabs without content. The other prices do not depend on `empty`.
    /// @param prices  priced(volume, thickness, ..., taken)
    void set_empty(EnergyVolume& prices, const EnergyVolume& volume, int thickness, float empty,
                   std::span<const Taken> taken) const;

    /// Prices of slabs without content, rising. The first price at which the content gives
    /// `enough` is used.
    static constexpr std::array<float, 5> emptiness{1.3f, 1.8f, 2.5f, 3.5f, 5.0f};
    /// Share that must come from the content, relative to even scaling.
    static constexpr double enough = 0.9;
    /// By how much a slab changes the width of the content, as a share of what scaling a window
    /// evenly would do. The content of a column reaches from its first to its last entry with
    /// content.
    /// @param at  the slab's first entry in each column
    double content_share(const EnergyVolume& volume, std::span<const std::uint16_t> at,
                         int thickness, Window window) const;

private:
    class Column;
    /// Prices of a frame's slabs with content, `[column][entry]`.
    std::vector<float> frame(const EnergyVolume& volume, int thickness, std::size_t t) const;
    /// Mean price of content without outlines: a join, and energy if there is any.
    double unit() const { return weights_.join + (energy_ > 0 ? 1 : 0); }

    SlabWeights weights_;
    float content_ = 0, level_ = 1;  ///< content_: content has an absolute field above this;
                                     ///< level_: half of the field's mean there
    double energy_ = 1,
           join_ = 1;  ///< mean energy of content, and mean difference of both sides of its slabs
};

}  // namespace fluidcarve
