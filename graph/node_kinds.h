#pragma once

#include "graph/document.h"
#include "graph/types/registry.h"

namespace fluidcarve {

/// The type of a node in a document: the one that it names, or the kind of it that its inputs ask
/// for (Declare::kind). Follows connections as written, so that nodes may stand in any order.
/// @param node  a map; null if no type of its name is known
const NodeType* type_of(const Value& node, const Document& document, const Registry& registry);

}  // namespace fluidcarve
