#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `image.write {source, path, channels, depth, quality}`: writes the float grids of a volume as an image (image_volume.h). The file
/// appears whole or not at all.
NodeType image_write();

}  // namespace fluidcarve
