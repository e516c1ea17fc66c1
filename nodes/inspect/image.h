#pragma once

#include "graph/types/registry.h"

namespace fluidcarve {

/// Inspector for images: format, size, channels, depths, ranges and oddities. Reads the whole file.
FileInspector image_inspector();

}  // namespace fluidcarve
