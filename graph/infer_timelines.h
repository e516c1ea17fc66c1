#pragma once

#include "carve/base/frame_set.h"
#include "graph/pipeline.h"

#include <vector>

namespace fluidcarve {

/// Finds Node::input_frames and Node::frames of all nodes. All inputs of a node must have the same
/// frames.
/// @param nodes     in order, with their rates
/// @param sequence  the frames of readers
/// @return the frames of all nodes together
FrameSet infer_timelines(const std::vector<Node*>& nodes, const FrameSet& sequence,
                         Problems& problems);

}  // namespace fluidcarve
