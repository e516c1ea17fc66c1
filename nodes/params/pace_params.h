#pragma once

#include "carve/time/pace.h"
#include "graph/types/node_type.h"

namespace fluidcarve {

constexpr double farthest_frame = 1e9;  ///< frame numbers must fit an int

/// The parameters of a node that retimes a sequence.
struct PaceParams : PaceRequest {
    InputPath curve_file;  ///< a CSV file with the curve; empty: none
};

/// Finds parameters of a pace that contradict each other.
void check_pace(const PaceParams& params, NodeCheck& check);

/// The pace that parameters give a sequence.
/// @param frames  numbers of the source's frames
/// @throws Failure as Pace, or naming file and line of a curve that can't be read
Pace pace_of(const PaceParams& params, const std::vector<int>& frames);

/// Declares the parameters of a node that retimes a sequence.
template <class Node>
Declare<Node>& declare_pace(Declare<Node>& node) {
    return node
        .param("speed", &PaceParams::speed, Unit::none, between(-1000, 1000),
               "Frames of the source per frame: 0.5 is half as fast and twice as long; -1 runs "
               "backwards.")
        .param("frames", &PaceParams::count, Unit::frames, between(1, 1e6),
               "Number of frames that show the whole source, instead of `speed`.")
        .param("curve", &PaceParams::curve,
               "Points [frame, frame of the source], instead of `speed`: [[1001, 1001], [1012, "
               "1024], [1036, 1024]] runs twice as fast, then holds. Linear between.")
        .param("curve_file", &PaceParams::curve_file,
               "A CSV file with the curve, as other applications write it: two columns, the frame "
               "and the frame of the source, a point per line. A first line may name them.")
        .param("start", &PaceParams::start, Unit::frames, between(-farthest_frame, farthest_frame),
               "Number of the first frame. auto is that of the source.");
}

}  // namespace fluidcarve
