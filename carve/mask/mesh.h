#pragma once

#include "carve/mesh/mesh.h"
#include "carve/volume/volume.h"

namespace fluidcarve {

/// The voxels whose centres lie in a closed mesh.
/// @param transform  of the mask; must have cubic voxels
/// @throws Failure if the mesh is not closed, or as mesh_distance
MaskGrid::Ptr inside_mask(const Mesh& mesh, const openvdb::math::Transform& transform);

/// The voxels whose centres lie near a face, on either side.
/// @param distance  maximum distance, world units
/// @throws Failure as mesh_distance
MaskGrid::Ptr near_mask(const Mesh& mesh, const openvdb::math::Transform& transform,
                        double distance);

}  // namespace fluidcarve
