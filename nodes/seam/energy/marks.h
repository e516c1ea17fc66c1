#pragma once

#include "nodes/field/missed_range.h"
#include "nodes/lattice/lattice.h"
#include "nodes/seam/energy/sample.h"

#include <openvdb/openvdb.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace fluidcarve {

/// How many vertices each mask of a solver marks; nothing: it has no such mask.
struct MarkCounts {
    std::optional<std::size_t> protect, attract;
    std::optional<MissedRange> protect_missed{}, attract_missed{};  ///< why a mask is empty, if it says so
};

/// Writes a code at all vertices of a lattice around which a mask is set, that is, active. A mask is set around a vertex if any of the 8
/// voxels whose centres surround the vertex is active. For a vertex on a voxel centre, within 1e-5 voxels, only that voxel counts; on a
/// line or face between centres, only the voxels at its ends or corners.
/// @param mask  of any type that can be carved
/// @param code  protected_code or attracted_code
/// @param codes  as sample_energy() fills it
/// @param planes  nothing: all
/// @return number of marked vertices
/// @throws Failure naming the type of a grid that is no mask
std::size_t mark_vertices(const openvdb::GridBase& mask, const Lattice& lattice, Axis axis, std::uint16_t code, std::span<std::uint16_t> codes,
                          std::optional<Planes> planes = {});

}  // namespace fluidcarve
