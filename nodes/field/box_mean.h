#pragma once

#include <openvdb/openvdb.h>

namespace fluidcarve {

/// The widest cubes of box_mean(), from the middle to the sides, voxels: that of a leaf.
constexpr int most_box_width = 8;

/// The mean over cubes of voxels, bit for bit as openvdb::tools::Filter::mean() computes it. It takes a fraction of the time, since it adds
/// whole rows of a leaf at once.
/// @param tree   its active voxels become means; inactive ones count with their value and keep it
/// @param width  from the middle of a cube to its sides, voxels: 1 to most_box_width
void box_mean(openvdb::FloatTree& tree, int width, int iterations);

}  // namespace fluidcarve
