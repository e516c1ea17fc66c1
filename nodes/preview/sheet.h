#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `preview.sheet`: draws a grid before and after a carve, the difference and the seams, for some
/// frames, as one PNG (SheetRows, draw_sheet).
NodeType preview_sheet();

}  // namespace fluidcarve
