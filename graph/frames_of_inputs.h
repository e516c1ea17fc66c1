#pragma once

#include "carve/base/frame_set.h"
#include "formats/file/path_pattern.h"
#include "graph/pipeline.h"
#include "graph/text/problem.h"

#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// An input of a pipeline with a frame token.
struct FramedInput {
    std::string node;
    PathPattern path;
    Mark mark;  ///< of the path
};

/// What `frames: auto` stands for: the frames that all inputs have. Lists folders, and opens no
/// file.
/// @param frames  the place of `auto`
/// @return nothing if a problem was added, or an input leads out of --confine, which is a problem
///   of its own
std::optional<FrameSet> frames_of_inputs(const std::vector<FramedInput>& inputs, const Mark& frames,
                                         Problems& problems);

/// Which frames are missing between others, in words; empty if none is, or if all are equally far
/// apart, as on twos.
std::string holes_in(const FrameSet& frames);

/// Names files that look like frames of an input and are left out; empty: there are none.
std::string note_on_odd_frames(const PathPattern& input);

/// Adds to a pipeline's notes the files of outputs that its sequence does not write, as those of an
/// earlier run.
void note_old_files(Pipeline& pipeline);

}  // namespace fluidcarve
