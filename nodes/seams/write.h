#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `seams.write {seams, path}`: writes a seam file (seam_file.h).
NodeType seams_write();

}  // namespace fluidcarve
