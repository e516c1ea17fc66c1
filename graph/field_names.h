#pragma once

#include "graph/text/problem.h"
#include "graph/text/value.h"
#include "graph/types/node_type.h"

#include <vector>

namespace fluidcarve {

/// Checks the names of a node's fields. Those that an extended file states for another type are
/// told at the new type, all at once, with what drops them.
/// @param node     the node's map
/// @param type     where its type is stated
/// @param sources  the pipeline's file, and then each file that the one before extends
void check_field_names(const Value& node, const Mark& type, const NodeType& node_type,
                       const std::vector<Mark>& sources, Problems& problems);

}  // namespace fluidcarve
