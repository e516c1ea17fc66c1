#pragma once

#include "graph/types/frames.h"

#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// Paths of the files right in a folder, in any order. @param folder  empty: the current folder
/// @throws Failure (input) if the folder can't be read
std::vector<std::string> files_in(const std::string& folder);

/// The frames of a path with frame tokens whose files are there; none if its folder is not there.
/// @return nothing if a token is in the path's folder
/// @throws Failure (input) if the folder can't be read
std::optional<FrameSet> frames_there(const PathPattern& path);

}  // namespace fluidcarve
