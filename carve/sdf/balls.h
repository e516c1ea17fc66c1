#pragma once

#include <openvdb/openvdb.h>

#include <span>

namespace fluidcarve {

/// Equal balls, and how far from their surface distances are known. Lengths are in voxels.
struct Balls {
    std::span<const openvdb::Vec3d> centres;  ///< index coordinates
    double radius, half_width;
};

/// Signed distances to the union of balls, negative inside: those of active voxels lie within the
/// half width. OpenVDB's ParticlesToLevelSet has the same values, but visits each voxel of each
/// ball by itself.
/// @param voxel  edge of a voxel, the unit of the distances
/// @return a tree whose background is the half width, times `voxel`
openvdb::FloatTree::Ptr distances_to_balls(const Balls& balls, double voxel);

}  // namespace fluidcarve
