#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

NodeType energy_python();
NodeType field_python();
NodeType mask_python();
NodeType points_python();
NodeType rig_python();
NodeType seam_python();

}  // namespace fluidcarve
