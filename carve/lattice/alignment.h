#pragma once

#include "carve/lattice/lattice.h"

#include <openvdb/math/Coord.h>
#include <openvdb/math/Transform.h>

#include <array>
#include <optional>

namespace fluidcarve {

/// Maps the vertices of a box lattice to voxels of a grid, in integers. Made by align().
struct Alignment {
    openvdb::Coord origin;               ///< voxel at vertex (0, 0, 0)
    std::array<openvdb::Coord, 3> step;  ///< voxels from a vertex to the next one along u, v, w

    /// The voxel at a vertex.
    openvdb::Coord voxel(int i, int j, int k) const {
        return {origin.x() + i * step[0].x() + j * step[1].x() + k * step[2].x(),
                origin.y() + i * step[0].y() + j * step[1].y() + k * step[2].y(),
                origin.z() + i * step[0].z() + j * step[1].z() + k * step[2].z()};
    }
    /// Whether neighbouring vertices are neighbouring voxels: each step is one voxel along an index
    /// axis of its own.
    bool one_to_one() const;
    /// The vertex at a voxel, also beyond the lattice. Requires one_to_one().
    openvdb::Coord vertex(const openvdb::Coord& voxel) const;
};

/// Aligns a box lattice with the voxels of a grid.
/// @param transform  of the grid
/// @return nothing if the lattice is no box, the transform is not linear, or a vertex lies further
///   than 2e-3 voxels from a voxel centre (the tolerance allows for rounded corners of a stated
///   box)
std::optional<Alignment> align(const Lattice& lattice, const openvdb::math::Transform& transform);

/// The lattice with its vertices moved exactly onto their voxels.
/// @param alignment  of the lattice with the transform; one_to_one()
Lattice on_voxels(const Lattice& lattice, const Alignment& alignment,
                  const openvdb::math::Transform& transform);

}  // namespace fluidcarve
