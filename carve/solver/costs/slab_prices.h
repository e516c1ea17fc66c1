#pragma once

#include "carve/solver/costs/volume.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace fluidcarve {

/// What slabs pay (METHOD 8 "Thick seams").
struct SlabWeights {
    /// Of the difference between both sides of a slab, beside the energy that goes with it.
    float join = 1;
    std::optional<float> empty;  ///< price where nothing is seen on either side, in mean prices of
                                 ///< content; nothing: see SlabPrices::emptiness
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
/// energy, and where it holds no outline. Where nothing is seen it has a price of its own. Prices
/// are in units of the whole sequence, so that the same weights serve any energy, field and
/// resolution.
class SlabPrices {
public:
    /// Measures a sequence.
    /// @param volume     energies without prices and edges, and a field
    /// @param thickness  of most slabs, vertices; at most the volume's width
    /// @throws Failure if the field is 0 at all vertices
    SlabPrices(const EnergyVolume& volume, int thickness, const SlabWeights& weights);

    /// A slab that was taken; others keep away from it, so that each part of the content gives its
    /// share.
    struct Taken {
        SeamEntries at;  ///< in each column: the first entry of a slab that is doubled, or the
                         ///< entry that now stands where a slab was
        int thickness;   ///< that it has: 0 if it was removed
    };
    /// The prices as a volume of their own: entry `i` of a column is the price of the slab of
    /// entries `i` to `i + thickness - 1`. A slab is protected if one of its entries is, or
    /// attracted.
    /// @param empty          price where nothing is seen, in mean prices of content
    /// @param volume         like the one that was measured; slabs may have been removed from it.
    ///   It lives as long as the prices
    /// @param taken          slabs that the next one is to keep away from
    /// @param memory_budget, folder  as for EnergyVolume
    EnergyVolume of(const EnergyVolume& volume, int thickness, float empty,
                    std::span<const Taken> taken, std::uint64_t memory_budget,
                    const std::string& folder) const;
    /// Sets the prices where nothing is seen; the others stay, since they do not depend on `empty`.
    /// @param prices  of(volume, thickness, ..., taken)
    void set_empty(EnergyVolume& prices, const EnergyVolume& volume, int thickness, float empty,
                   std::span<const Taken> taken) const;

    /// Prices of what is empty, from low to high. The first with which the content gives its share
    /// is taken.
    static constexpr std::array<float, 5> emptiness{1.3f, 1.8f, 2.5f, 3.5f, 5.0f};
    /// Of the share that even scaling would take from the content.
    static constexpr double enough = 0.9;
    /// By how much a slab changes the width of the content, as a share of what scaling a window
    /// evenly would do. The content of a column lies between its first and its last entry where
    /// something is seen.
    /// @param at  the slab's first entry in each column
    double content_share(const EnergyVolume& volume, std::span<const std::uint16_t> at,
                         int thickness, Window window) const;

private:
    class Column;
    /// Prices of a frame's slabs where something is seen, `[column][entry]`.
    std::vector<float> frame(const EnergyVolume& volume, int thickness, std::size_t t) const;
    /// Mean price of content, but for outlines: a join, and energy if there is any.
    double unit() const { return weights_.join + (energy_ > 0 ? 1 : 0); }

    SlabWeights weights_;
    float content_ = 0, level_ = 1;  ///< content is what has a field above the first; the second is
                                     ///< half of the field's mean there
    double energy_ = 1,
           join_ = 1;  ///< mean energy of content, and mean difference of both sides of its slabs
};

}  // namespace fluidcarve
