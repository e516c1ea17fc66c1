#pragma once

#include "carve/time/pace.h"
#include "graph/types/node_type.h"

namespace fluidcarve {

constexpr double farthest_frame = 1e9;  ///< numbers of frames must stay whole numbers

/// Finds parameters of a pace that do not go together.
void check_pace(const PaceWish& wish, NodeCheck& check);

/// Declares the parameters of a node that gives a sequence another pace.
template <class Node>
Declare<Node>& declare_pace(Declare<Node>& node) {
    return node
        .param("speed", &PaceWish::speed, Unit::none, between(-1000, 1000),
               "Frames of the source per frame: 0.5 is half as fast and twice as long; -1 runs "
               "backwards.")
        .param("frames", &PaceWish::count, Unit::frames, between(1, 1e6),
               "Number of frames that show the whole source, instead of `speed`.")
        .param("curve", &PaceWish::curve,
               "Points [frame, frame of the source], instead of `speed`: [[1001, 1001], [1012, "
               "1024], [1036, 1024]] runs twice as fast, then holds. Linear between.")
        .param("start", &PaceWish::start, Unit::frames, between(-farthest_frame, farthest_frame),
               "Number of the first frame. auto is that of the source.");
}

}  // namespace fluidcarve
