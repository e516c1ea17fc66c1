#pragma once

#include "tools/inspect/inspector.h"

namespace fluidcarve {

/// Inspector for images: format, size, channels, depths, ranges and oddities. Reads the whole file.
FileInspector image_inspector();

}  // namespace fluidcarve
