#pragma once

#include "carve/base/frame_set.h"
#include "formats/file/path_pattern.h"

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

/// What a frame set with a colon says, for those who take it for a step: "1-10:2 names all of the
/// frames, ..."; empty: it has none.
std::string staggered_note(std::string_view frames);

/// Names of files that lie beside those of a path with frame tokens and look like frames of it, but
/// are none: half frames such as 1001.5, or numbers with other digits. At most three.
std::vector<std::string> odd_frames_there(const PathPattern& path);

}  // namespace fluidcarve
