#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>

namespace fluidcarve {

/// What a grid may always take, however little memory a node has: bytes.
inline constexpr std::uint64_t least_grid_memory = std::uint64_t{64} << 20;

/// Whether a grid of this size may be made. @param bytes, budget  bytes; the budget is that of all
/// frames (Limits)
bool grid_fits(double bytes, std::uint64_t budget);

/// Bytes of a voxel in a leaf of states, such as that of a mask.
inline constexpr double state_bytes = 0.25;

/// Checks, before all active tiles of a grid become voxels, that these fit in memory.
/// @param value_bytes  bytes of a voxel's value
/// @param budget       as in grid_fits
/// @throws Failure (input) naming grid, voxels, memory and remedy
void require_dense_fits(const openvdb::GridBase& grid, double value_bytes, std::uint64_t budget);

}  // namespace fluidcarve
