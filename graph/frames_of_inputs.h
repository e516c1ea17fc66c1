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

/// The value of `frames: auto`: the frames that all inputs have. Lists folders, but opens no file.
/// @param frames  the place of `auto`
/// @return nothing if a problem was added, or an input leads out of --confine, which is a problem
///   of its own
std::optional<FrameSet> frames_of_inputs(const std::vector<FramedInput>& inputs, const Mark& frames,
                                         Problems& problems);

/// Which frames are missing between others, in words; empty if none is missing, or if all are
/// evenly spaced, as on twos.
std::string holes_in(const FrameSet& frames);

/// A note naming files that look like frames of an input, but are not; empty if there are none.
std::string note_on_odd_frames(const PathPattern& input);

}  // namespace fluidcarve
