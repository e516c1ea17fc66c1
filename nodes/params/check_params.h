#pragma once

#include "carve/solver/task/params.h"
#include "graph/types/node_check.h"

#include <cstddef>

namespace fluidcarve {

/// Requires that a box's upper corner is not below its lower one along a dimension.
/// @return whether that holds
bool check_corners(const Vec3& min, const Vec3& max, std::size_t dimension, NodeCheck& check);
/// The same along all dimensions.
void check_corners(const Vec3& min, const Vec3& max, NodeCheck& check);
/// Requires that a vector is not zero.
/// @param field  the field that holds it
void check_direction(const char* field, const Vec3& direction, NodeCheck& check);
/// Requires that an anchor is `low`, `middle`, `high`, or a vertex of at least 0.
void check_anchor(const Anchor& anchor, NodeCheck& check);

/// Finds parameters that contradict each other, lack an input that they need, or conflict with
/// one.
void check_params(const SolverParams& params, NodeCheck& check);

}  // namespace fluidcarve
