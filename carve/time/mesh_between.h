#pragma once

#include "carve/mesh/mesh.h"
#include "carve/time/points_between.h"

namespace fluidcarve {

/// Whether two meshes have the same faces, so that vertices can move from one to the other.
bool same_faces(const Mesh& a, const Mesh& b);

/// The mesh at a moment between two frames of the same faces, which may differ from place to
/// place: vertices, and float attributes of both frames, are interpolated linearly. Other
/// attributes are those of the nearer frame. If the faces differ, the whole mesh is that of the
/// nearer frame.
/// @param share   position in time between `a` (0) and `b` (1), at a vertex's position in `a`
/// @param nearer  `a` or `b`
Mesh mesh_between(const Mesh& a, const Mesh& b, const ShareAt& share, const Mesh& nearer);
/// The same with one moment for all places.
Mesh mesh_between(const Mesh& a, const Mesh& b, double share);

/// Mean squared distance of the vertices of two frames with the same faces, world units squared; 0
/// if there are none.
double squared_distance(const Mesh& a, const Mesh& b);

}  // namespace fluidcarve
