#pragma once

#include "graph/document.h"
#include "graph/types/registry.h"

namespace fluidcarve {

/// The type of a node in a document: the named type, or the kind of it that its inputs select
/// (Declare::kind). Follows connections as written, so that nodes may stand in any order.
/// @param node  a map
/// @return null if the named type is unknown
const NodeType* type_of(const Value& node, const Document& document, const Registry& registry);

}  // namespace fluidcarve
