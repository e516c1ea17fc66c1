#pragma once

#include "nodes/lattice/lattice.h"

#include <openvdb/openvdb.h>

#include <cstdint>
#include <optional>
#include <span>

namespace fluidcarve {

/// How much a vertex counts.
enum class Measure {
    vertex,  ///< as much as any other
    volume,  ///< as much as the space nearest to it, in cubes of the lattice's spacing
};

/// Planes of a lattice that follow one another.
struct Planes {
    int first, count;
};

/// Samples one frame's energy at the vertices of a lattice (METHOD 1, `E(i,j,k)`), as energy codes. Each column is contiguous along the
/// carved axis; column `(lateral, k)` has the index `lateral + laterals * k`.
/// A vertex on a voxel centre (within 1e-5 voxels) takes the voxel's value; elsewhere the grid is sampled trilinearly. Inactive voxels
/// count as well. By volume, energies are multiplied by |det Dg| / spacing^3 (METHOD 7 "Measure"), which is 1 in straight boxes. Where this
/// factor exceeds 1, the energy is the mean of that many samples across the planes.
/// @param codes   an entry for each vertex of the planes
/// @param planes  nothing: all
/// @throws Failure naming the place of a negative, infinite, too large or undefined energy
void sample_energy(const openvdb::FloatGrid& energy, const Lattice& lattice, Axis axis, std::span<std::uint16_t> codes, Measure measure = Measure::vertex,
                   std::optional<Planes> planes = {});

/// The same for a field, as field codes, always at the vertices.
/// @throws Failure naming the place of a value that codes cannot hold
void sample_field(const openvdb::FloatGrid& field, const Lattice& lattice, Axis axis, std::span<std::uint16_t> codes, std::optional<Planes> planes = {});

}  // namespace fluidcarve
