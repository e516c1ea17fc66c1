#pragma once

#include <openvdb/openvdb.h>

#include <span>

namespace fluidcarve {

/// Equal balls, and the half width of the narrow band around their surface. Lengths are in voxels.
struct Balls {
    std::span<const openvdb::Vec3d> centres;  ///< index coordinates
    double radius, half_width;
};

/// Signed distances to the union of balls, negative inside. Voxels within the half width are
/// active. OpenVDB's ParticlesToLevelSet gives the same values, but visits every voxel of every
/// ball.
/// @param voxel  edge of a voxel, the unit of the distances
/// @return a tree whose background is the half width, times `voxel`
openvdb::FloatTree::Ptr distances_to_balls(const Balls& balls, double voxel);

}  // namespace fluidcarve
