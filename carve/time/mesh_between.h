#pragma once

#include "carve/mesh/mesh.h"

namespace fluidcarve {

/// Whether two meshes have the same faces, so that vertices can move from one to the other.
bool same_faces(const Mesh& a, const Mesh& b);

/// The mesh at a moment between two frames of the same faces: vertices, and attributes of floats
/// that both have, lie on straight ways between; other attributes are those of the nearer frame.
/// @param share  of the way from `a` to `b`, between 0 and 1
Mesh mesh_between(const Mesh& a, const Mesh& b, double share);

/// How far the vertices of two frames of the same faces lie apart: the mean of their squared
/// distances, world units squared; 0 if there are none.
double squared_distance(const Mesh& a, const Mesh& b);

}  // namespace fluidcarve
