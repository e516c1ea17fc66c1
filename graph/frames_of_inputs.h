#pragma once

#include "graph/text/problem.h"
#include "graph/types/frames.h"

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

/// What `frames: auto` stands for: the frames that all inputs have. Lists folders, and opens no file.
/// @param frames  the place of `auto`
/// @return nothing if a problem was added, or an input leads out of --confine, which is a problem of its own
std::optional<FrameSet> frames_of_inputs(const std::vector<FramedInput>& inputs, const Mark& frames, Problems& problems);

}  // namespace fluidcarve
