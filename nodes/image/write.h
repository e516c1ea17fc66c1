#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `image.write {source, path, channels, depth, quality}`: the float grids of a volume to an image, which appears whole or not at
/// all (image_volume.h).
NodeType image_write();

}  // namespace fluidcarve
