#pragma once

#include "carve/lattice/lattice.h"

#include <openvdb/openvdb.h>

#include <cstdint>

namespace fluidcarve {

/// How much of a grid's content lies in a lattice.
struct Content {
    std::uint64_t voxels = 0;  ///< active voxels, including those of tiles
    /// Number of them in the lattice; an estimate from a sample if there are many voxels.
    double inside = 0;

    void add(const Content& other) {
        voxels += other.voxels;
        inside += other.inside;
    }
    /// 0 to 1; only if there are voxels.
    double share() const { return inside / static_cast<double>(voxels); }
};

/// Counts the active voxels of a grid in a lattice. A voxel lies in the lattice if its centre is
/// at most half a spacing from the vertices, or half a voxel if that is more. Looks at 65536
/// voxels at most, spread evenly.
Content content_in(const openvdb::FloatGrid& grid, const Lattice& lattice);

}  // namespace fluidcarve
