#pragma once

#include "nodes/mesh/mesh.h"

#include <array>

namespace fluidcarve {

/// A face cut into triangles along its own diagonals, by clipping ears: right for concave faces too, as far as they are flat. Each
/// triangle is turned as the face is.
/// @param points  of the mesh
/// @param out     becomes vertices of the mesh, three by three: two fewer triangles than corners
void triangulate(const std::vector<openvdb::Vec3d>& points, std::span<const std::uint32_t> face, std::vector<std::array<std::uint32_t, 3>>& out);

}  // namespace fluidcarve
