#pragma once

#include "nodes/seam/seams.h"
#include "nodes/seam/slab_store.h"

#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace fluidcarve {

/// The energy `E(i,j,k,t)` in which seams are found, and from which found seams are deleted: one slab of energy codes
/// per frame (layout: sample_energy).
class EnergyVolume {
public:
    /// All energies 0. @throws Failure as SlabStore
    /// @param closed  column k = K-1 is a neighbour of k = 0
    EnergyVolume(const std::array<int, 3>& shape, Axis axis, std::size_t frames, std::uint64_t memory_budget, const std::string& folder, bool closed = false);

    /// What a seam costs that is the same in all frames: one frame of energies summed over the frames, 32-bit floats in
    /// place of codes.
    EnergyVolume sum() const;
    bool summed() const { return !sums_.empty(); }

    int width() const { return width_; }  ///< entries per column, fewer after each deletion
    int laterals() const { return laterals_; }
    int slices() const { return slices_; }  ///< columns per frame are laterals * slices
    std::size_t columns_per_frame() const { return static_cast<std::size_t>(laterals_) * static_cast<std::size_t>(slices_); }
    std::size_t frames() const { return slabs_.count(); }
    std::size_t stride() const { return stride_; }  ///< entries from a column to the next
    bool closed() const { return closed_; }

    std::span<std::uint16_t> slab(std::size_t t) { return slabs_.slab(t); }
    const std::uint16_t* slab(std::size_t t) const { return slabs_.slab(t).data(); }
    /// A frame's entries: codes (std::uint16_t), or float if summed().
    template <class Cell>
    const Cell* cells(std::size_t t) const {
        if constexpr (std::is_same_v<Cell, float>) return sums_.data();
        else return slab(t);
    }

    /// Deletes one entry of each column; what is behind it moves up.
    /// @param at  as Seams::Seam::at, each below width()
    void remove(std::span<const std::uint16_t> at);
    /// In how many columns a seam meets no energy. @param at  as for remove
    std::size_t zeros(std::span<const std::uint16_t> at) const;

private:
    EnergyVolume(const EnergyVolume& whole, std::vector<float> sums);

    int width_, laterals_, slices_;
    std::size_t stride_;
    bool closed_;
    SlabStore slabs_;
    std::vector<float> sums_;
};

}  // namespace fluidcarve
