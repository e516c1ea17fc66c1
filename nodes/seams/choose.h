#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `seams.choose`: keeps as many of the first seams of a set as look best, and leaves the rest of the carve to a warp (METHOD 11 "Seams or a warp").
NodeType seams_choose();

}  // namespace fluidcarve
