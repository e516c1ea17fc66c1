#pragma once

#include "tools/compare/file_comparer.h"

#include <openvdb/openvdb.h>

#include <string>

namespace fluidcarve {

/// The differences of two numbers or vectors: 0 if they are equal or both are NaN, infinite if it
/// is no finite number. Of vectors, the length of their difference.
double difference_of(double a, double b);

/// Compares two grids, voxel by voxel of one index space: all that are active in either. Tiles
/// count as their voxels, and are not turned into such. Inactive voxels count with their stored
/// value. Points are compared by their positions, in the order of the grids. The result does not
/// depend on the number of threads.
/// @param paths  of the files, for messages
/// @return faults: types, transforms, classes or backgrounds that differ, numbers of points, other
///   bytes in grids of a type that OpenVDB does not know; values are compared only if the types are
///   the same
/// @throws Failure (input) if a grid's points are damaged
PartDifference compare_grids(const std::string& name, const openvdb::GridBase& a,
                             const openvdb::GridBase& b, const FilePair& paths,
                             const Tolerance& tolerance);

/// Compares positions one by one. @param values  what they are: "vertices"
/// @return a fault if there are not as many
PartDifference compare_positions(const std::string& name, const std::string& values,
                                 const std::vector<openvdb::Vec3d>& a,
                                 const std::vector<openvdb::Vec3d>& b, const Tolerance& tolerance);

}  // namespace fluidcarve
