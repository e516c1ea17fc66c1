#pragma once

#include "nodes/seam/seams.h"
#include "nodes/seam/slab_store.h"

#include <cstdint>
#include <span>
#include <string>

namespace fluidcarve {

/// The energy `E(i,j,k,t)` in which seams are found, and from which found seams are deleted: one slab of energy codes
/// per frame (layout: sample_energy).
class EnergyVolume {
public:
    /// All energies 0. @throws Failure as SlabStore
    EnergyVolume(const std::array<int, 3>& shape, Axis axis, std::size_t frames, std::uint64_t memory_budget, const std::string& folder);

    int width() const { return width_; }  ///< entries per column, fewer after each deletion
    int laterals() const { return laterals_; }
    int slices() const { return slices_; }  ///< columns per frame are laterals * slices
    std::size_t columns_per_frame() const { return static_cast<std::size_t>(laterals_) * static_cast<std::size_t>(slices_); }
    std::size_t frames() const { return slabs_.count(); }
    std::size_t stride() const { return stride_; }  ///< codes from a column to the next

    std::span<std::uint16_t> slab(std::size_t t) { return slabs_.slab(t); }
    const std::uint16_t* slab(std::size_t t) const { return slabs_.slab(t).data(); }

    /// Deletes one entry of each column; what is behind it moves up.
    /// @param at  as Seams::Seam::at, each below width()
    void remove(std::span<const std::uint16_t> at);

private:
    int width_, laterals_, slices_;
    std::size_t stride_;
    SlabStore slabs_;
};

}  // namespace fluidcarve
