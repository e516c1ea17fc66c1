#pragma once

#include "carve/lattice/lattice.h"

#include <openvdb/openvdb.h>

#include <cstdint>

namespace fluidcarve {

/// How much of a grid's content lies in a lattice.
struct Content {
    std::uint64_t voxels = 0;  ///< active ones, those of tiles included
    /// How many of them lie in the lattice; of many voxels, an estimate by some.
    double inside = 0;

    void add(const Content& other) {
        voxels += other.voxels;
        inside += other.inside;
    }
    double share() const {
        return inside / static_cast<double>(voxels);
    }  ///< 0 to 1; only if there are voxels
};

/// Counts the active voxels of a grid in a lattice. A voxel lies in it if its centre is no further
/// from the vertices than half of a spacing, or half of a voxel if that is more. Looks at 65536
/// voxels at most, spread evenly.
Content content_in(const openvdb::FloatGrid& grid, const Lattice& lattice);

}  // namespace fluidcarve
