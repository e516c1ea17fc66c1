#pragma once

#include "carve/base/frame_set.h"
#include "formats/file/path_pattern.h"

#include <functional>
#include <string>
#include <vector>

namespace fluidcarve {

/// Files whose names differ only by a frame number before the ending, or one file.
struct FileSequence {
    PathPattern path;  ///< with a frame token: "smoke.####.vdb"; one file: its path as it is
    FrameSet frames = FrameSet({1});  ///< those whose files are there; of one file any one

    bool per_frame() const { return path.per_frame(); }
    /// "smoke.####.vdb 1001-1084", or the path of one file.
    std::string text() const;
};

/// Groups files to sequences, in the order of the first file of each. A lone file stays one,
/// whatever its name.
std::vector<FileSequence> sequences_of(const std::vector<std::string>& paths);

/// The files right in a folder that are wanted, as sequences, sorted by path.
/// @param others  set to the number of files that are not
/// @throws Failure (input) if the folder can't be read
std::vector<FileSequence> sequences_in(const std::string& folder,
                                       const std::function<bool(const std::string& path)>& wanted,
                                       std::size_t& others);

/// What an argument of the command line names: the files of a path with frame tokens that are
/// there, or one file.
/// @throws Failure if part of it looks like a frame token and is none
FileSequence named_sequence(const std::string& argument);

}  // namespace fluidcarve
