#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `image.read {path, channels, missing}`: reads an image as a volume with one float grid per channel (image_volume.h).
NodeType image_read();

}  // namespace fluidcarve
