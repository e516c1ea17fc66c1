#pragma once

#include "nodes/lattice/lattice.h"

#include <openvdb/openvdb.h>

#include <cstdint>
#include <span>

namespace fluidcarve {

/// What a vertex stands for.
enum class Measure {
    vertex,  ///< itself, wherever it is
    volume,  ///< the space that is nearest to it, in cubes of the lattice's spacing
};

/// One frame's energy at the vertices of a lattice (METHOD 1, `E(i,j,k)`), in energy codes: column after column, each
/// contiguous along the carved axis; column `(lateral, k)` is the `lateral + laterals * k`-th.
/// Where vertices are voxel centres within 1e-5 their values are taken, elsewhere the grid is sampled trilinearly;
/// active or not makes no difference. By volume, energies are multiplied with |det Dg| / spacing^3 (METHOD 7 "measure"),
/// which is 1 in straight boxes; where it is more, the energy is the mean of as many samples across the planes.
/// @param slab  I * J * K entries
/// @throws Failure that names the place of a negative, infinite, too large or undefined energy
void sample_energy(const openvdb::FloatGrid& energy, const Lattice& lattice, Axis axis, std::span<std::uint16_t> slab, Measure measure = Measure::vertex);

/// The same for a field, in field codes, at the vertices. @throws Failure that names the place of a value that codes do not hold
void sample_field(const openvdb::FloatGrid& field, const Lattice& lattice, Axis axis, std::span<std::uint16_t> slab);

/// Whether the lattice and the active voxels of a grid meet at all, by their world boxes.
bool meets_active_voxels(const openvdb::GridBase& grid, const Lattice& lattice);

}  // namespace fluidcarve
