#pragma once

#include <openvdb/openvdb.h>

#include <optional>

namespace fluidcarve {

/// Measures of a grid's content in one frame. The amount of a voxel is its absolute value; in a
/// level set, the share of the voxel that is inside, from 0 to 1. Only active voxels count; in a
/// level set, all. Values that are not finite, or beyond the range of floats, count as 0.
struct GridMeasure {
    /// Around the active voxels, to their outer faces, world units; empty() without any.
    openvdb::BBoxd box;
    double mass = 0;  ///< sum of the amounts times the volume of a voxel, cubic world units; of a
                      ///< level set, its volume
    std::optional<double> highest;  ///< highest amount; nothing for level sets
    openvdb::Vec3d centre{0};       ///< centre of mass, world units; 0 without mass
};

/// Measures a float or double grid, in one parallel pass. The result does not depend on the number
/// of threads.
/// @return nothing for grids of other types
std::optional<GridMeasure> measured(const openvdb::GridBase& grid);

/// Cube root of the volume of a voxel, world units.
double voxel_edge(const openvdb::GridBase& grid);

}  // namespace fluidcarve
