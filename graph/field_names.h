#pragma once

#include "graph/text/problem.h"
#include "graph/text/value.h"
#include "graph/types/node_type.h"

#include <vector>

namespace fluidcarve {

/// Checks the names of a node's fields. Unknown fields that an extended file states for another
/// type become one problem at the new type, with the remedy.
/// @param node     the node's map
/// @param type     where its type is stated
/// @param sources  the pipeline's file, then each file that the previous one extends
void check_field_names(const Value& node, const Mark& type, const NodeType& node_type,
                       const std::vector<Mark>& sources, Problems& problems);

}  // namespace fluidcarve
