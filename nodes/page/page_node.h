#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// The node type preview.page.
NodeType preview_page();

}  // namespace fluidcarve
