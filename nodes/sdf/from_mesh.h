#pragma once

#include "graph/types/node_type.h"
#include "nodes/mesh/mesh.h"
#include "nodes/payloads.h"

#include <optional>

namespace fluidcarve {

/// Distances to the faces of a mesh, as far as a narrow band reaches. Without a thickness: of a closed mesh (Topology::closed)
/// signed, below 0 inside; of any other above 0 on both sides. With one: signed, below 0 in a shell of that thickness around
/// the faces. Signed ones are level sets.
/// @param mesh       faces of more than three corners are cut into triangles
/// @param transform  of the grid; cubic voxels
/// @param band       half the width of the narrow band, voxels, at least 2
/// @param thickness  world units, above 0
/// @return world units; named "surface"
/// @throws Failure if the mesh is too large or too far away for voxels of this size
FloatGrid::Ptr mesh_distance(const Mesh& mesh, const openvdb::math::Transform& transform, double band, std::optional<double> thickness);

/// The same without a sign, whatever the mesh.
FloatGrid::Ptr mesh_distance_unsigned(const Mesh& mesh, const openvdb::math::Transform& transform, double band);

NodeType sdf_from_mesh();

}  // namespace fluidcarve
