#pragma once

#include "nodes/lattice/lattice.h"

#include <openvdb/math/Coord.h>
#include <openvdb/math/Transform.h>

#include <array>
#include <optional>

namespace fluidcarve {

/// Where the vertices of a box lattice are voxels of a grid: from here on whole numbers suffice.
struct Alignment {
    openvdb::Coord origin;               ///< voxel of vertex (0, 0, 0)
    std::array<openvdb::Coord, 3> step;  ///< voxels from a vertex to the next along u, v, w

    openvdb::Coord voxel(int i, int j, int k) const {
        return {origin.x() + i * step[0].x() + j * step[1].x() + k * step[2].x(), origin.y() + i * step[0].y() + j * step[1].y() + k * step[2].y(),
                origin.z() + i * step[0].z() + j * step[1].z() + k * step[2].z()};
    }
    /// Whether neighbouring vertices are neighbouring voxels: each step one voxel along an index axis of its own.
    bool one_to_one() const;
    /// The vertex at a voxel, also beyond the lattice. Needs one_to_one.
    openvdb::Coord vertex(const openvdb::Coord& voxel) const;
};

/// The alignment of a lattice and a grid's transform, if every vertex lies within 2e-3 voxels of a voxel
/// centre: the corners of a stated box come rounded.
std::optional<Alignment> align(const Lattice& lattice, const openvdb::math::Transform& transform);

}  // namespace fluidcarve
