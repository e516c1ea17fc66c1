#pragma once

#include "nodes/lattice/lattice.h"

#include <openvdb/openvdb.h>

#include <cstddef>
#include <cstdint>
#include <span>

namespace fluidcarve {

/// Writes a code at the vertices of a lattice around which a mask is set, that is active: at any of the 8 voxels between
/// whose centres the vertex stands; of a vertex on a centre, within 1e-5 voxels, that voxel alone, on the line or face
/// between centres those at its ends or corners.
/// @param mask  of any type that can be carved
/// @param code  protected_code or attracted_code
/// @param slab  as sample_energy fills it
/// @return how many vertices that are
/// @throws Failure naming the type of a grid that is no mask
std::size_t mark_vertices(const openvdb::GridBase& mask, const Lattice& lattice, Axis axis, std::uint16_t code, std::span<std::uint16_t> slab);

}  // namespace fluidcarve
