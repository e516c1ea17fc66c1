#pragma once

#include "carve/base/frame_set.h"
#include "formats/file/path_pattern.h"

#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// Paths of the files directly in a folder, in any order. @param folder  empty: the current folder
/// @throws Failure (input) if the folder can't be read
std::vector<std::string> files_in(const std::string& folder);

/// The frames of a path with frame tokens whose files exist; none if the folder does not exist.
/// @return nothing if a token is in the path's folder
/// @throws Failure (input) if the folder can't be read
std::optional<FrameSet> frames_there(const PathPattern& path);

/// Names of files that look like frames of a path with frame tokens, but are not: half frames such
/// as 1001.5, or numbers with other digits. At most three.
std::vector<std::string> odd_frames_there(const PathPattern& path);

}  // namespace fluidcarve
