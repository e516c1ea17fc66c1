#pragma once

#include "carve/mesh/mesh.h"
#include "carve/volume/volume.h"

#include <optional>

namespace fluidcarve {

/// Distances to the faces of a mesh in a narrow band. Without a thickness they are signed for a
/// closed mesh (boundary_edges() is 0), negative inside, and unsigned for any other mesh. With a
/// thickness they are signed, negative in a shell of that thickness around the faces. Signed
/// distances are level sets.
/// @param mesh       faces with more than three corners are triangulated
/// @param transform  of the grid; must have cubic voxels
/// @param band       half width of the narrow band, voxels, at least 2
/// @param thickness  thickness of the shell, world units, above 0
/// @return a grid "surface", world units
/// @throws Failure if the mesh is too large or too far away for voxels of this size
FloatGrid::Ptr mesh_distance(const Mesh& mesh, const openvdb::math::Transform& transform,
                             double band, std::optional<double> thickness);

/// Unsigned distances, for any mesh.
FloatGrid::Ptr mesh_distance_unsigned(const Mesh& mesh, const openvdb::math::Transform& transform,
                                      double band);

}  // namespace fluidcarve
