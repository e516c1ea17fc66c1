#pragma once

#include "carve/base/limits.h"
#include "carve/seam/window.h"
#include "carve/solver/costs/energy_volume.h"
#include "carve/solver/costs/slab_prices.h"
#include "carve/solver/search/find_seam.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace fluidcarve {

/// Slabs, seams of several vertices (METHOD 8 "Thick seams"): finds each in prices of its own, and
/// keeps those that were taken. Slabs that are removed leave the volume, doubled ones stay in it.
class SlabSearch {
public:
    /// @param volume   is measured; must outlive the slabs
    /// @param thick    with the thickness of most slabs
    /// @param doubled  whether slabs are doubled, not removed
    /// @param static_  whether a slab is the same in all frames, found in the sum of their prices
    /// @param limits   must outlive the slabs
    /// @throws Failure as SlabPrices
    SlabSearch(EnergyVolume& volume, const Thick& thick, bool doubled, bool static_,
               const Limits& limits)
        : volume_(volume),
          thick_(thick),
          doubled_(doubled),
          static_(static_),
          limits_(limits),
          measured_(volume, thick.thickness, thick.weights) {}

    /// Sets the prices of slabs of a thickness, before each find().
    void price(int thickness);
    /// The prices that price() set.
    const EnergyVolume& prices() const { return sum_ ? *sum_ : *prices_; }

    /// Finds a slab in the prices. Empty slabs become dearer until the content gives its share.
    /// @param left    the entries with which it may begin
    /// @param number  number of slabs found before
    Seams::Seam find(const FindSeam& solver, int thickness, Window left, int number,
                     const Tick& tick);

    /// Takes a slab, so that later ones keep away from it.
    /// @param at  its first entry in each column; of one frame for static seams
    void take(std::span<const std::uint16_t> at, int thickness);

private:
    SeamEntries in_all_frames(std::span<const std::uint16_t> at) const;

    EnergyVolume& volume_;
    const Thick thick_;
    const bool doubled_;
    const bool static_;
    const Limits& limits_;
    const SlabPrices measured_;
    std::optional<EnergyVolume> prices_;
    std::optional<EnergyVolume> sum_;  ///< of the prices of all frames, for static seams
    std::vector<SlabPrices::Taken> taken_;
};

}  // namespace fluidcarve
