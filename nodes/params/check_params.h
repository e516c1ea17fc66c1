#pragma once

#include "carve/solver/task/params.h"
#include "graph/types/node_check.h"

#include <cstddef>

namespace fluidcarve {

/// Requires that a box's upper corner is not below its lower one along a dimension.
/// @return whether it is not
bool check_corners(const Vec3& min, const Vec3& max, std::size_t dimension, NodeCheck& check);
/// The same along all dimensions.
void check_corners(const Vec3& min, const Vec3& max, NodeCheck& check);
/// Requires an end, or a vertex from 0 on.
void check_anchor(const Anchor& anchor, NodeCheck& check);

/// Finds parameters that do not go together, and such that want an input or are at odds with one.
void check_params(const SolverParams& params, NodeCheck& check);

}  // namespace fluidcarve
