#pragma once

#include "carve/mesh/mesh.h"
#include "carve/time/points_between.h"

namespace fluidcarve {

/// Whether two meshes have the same faces, so that vertices can move from one to the other.
bool same_faces(const Mesh& a, const Mesh& b);

/// The mesh at a moment between two frames of the same faces, which may differ from place to place:
/// vertices, and attributes of floats that both have, lie on straight ways between. Other
/// attributes are those of the nearer frame, and so is all of meshes of other faces.
/// @param share   of the way from `a` to `b`, from 0 to 1, where a vertex is in `a`
/// @param nearer  `a` or `b`
Mesh mesh_between(const Mesh& a, const Mesh& b, const ShareAt& share, const Mesh& nearer);
/// The same with one moment for all places.
Mesh mesh_between(const Mesh& a, const Mesh& b, double share);

/// How far the vertices of two frames of the same faces lie apart: the mean of their squared
/// distances, world units squared; 0 if there are none.
double squared_distance(const Mesh& a, const Mesh& b);

}  // namespace fluidcarve
