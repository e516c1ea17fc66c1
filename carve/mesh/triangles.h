#pragma once

#include "carve/mesh/mesh.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace fluidcarve {

/// Triangulates a face by ear clipping, also a concave one if it is flat. Triangles have the
/// orientation of the face.
/// @param points  vertex positions of the mesh
/// @param face    vertices of the face
/// @param out     receives the triangles as vertices of the mesh: two fewer than the face has
///   corners
void triangulate(const std::vector<openvdb::Vec3d>& points, std::span<const std::uint32_t> face,
                 std::vector<std::array<std::uint32_t, 3>>& out);

}  // namespace fluidcarve
