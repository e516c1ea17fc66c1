#pragma once

#include <openvdb/openvdb.h>

#include <array>

namespace fluidcarve {

/// The widest cubes of box_mean(), from the middle to the sides, voxels: that of a leaf.
constexpr int most_box_width = 8;

/// The mean over cubes of voxels, as openvdb::tools::Filter::mean() computes it, bit for bit with
/// its order of axes: 0, 2, 1. It takes a fraction of the time, since it adds whole rows of a leaf
/// at once. Near inactive voxels, the result depends on the order.
/// @param tree   its active voxels become means; inactive ones count with their value and keep it
/// @param width  from the middle of a cube to its sides, voxels: 1 to most_box_width
/// @param order  the axes along which means are taken, one after another
void box_mean(openvdb::FloatTree& tree, int width, int iterations, const std::array<int, 3>& order);

}  // namespace fluidcarve
