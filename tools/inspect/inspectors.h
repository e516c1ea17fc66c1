#pragma once

#include "tools/inspect/inspector.h"

#include <string>
#include <vector>

namespace fluidcarve {

/// All inspectors: of volumes, of geometry and of images.
const std::vector<FileInspector>& inspectors();
/// The inspector for a file, by its ending; null: none.
const FileInspector* inspector_of(const std::string& path);

}  // namespace fluidcarve
