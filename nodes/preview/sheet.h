#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `preview.sheet`: a grid before and after, what differs, and the seams, for some frames of the sequence, in one PNG
/// (SheetRows, draw_sheet).
NodeType preview_sheet();

}  // namespace fluidcarve
