#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `image.read {path, channels, missing}`: a volume with a float grid for each channel of an image (image_volume.h).
NodeType image_read();

}  // namespace fluidcarve
