#include "nodes/params/pace_params.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>

namespace fluidcarve {

void check_pace(const PaceWish& wish, NodeCheck& check) {
    const int stated =
        int(wish.speed.has_value()) + int(wish.count.has_value()) + int(!wish.curve.empty());
    if (stated == 0) check.fault("type", "needs a 'speed', a number of 'frames', or a 'curve'");
    if (stated > 1) check.fault("type", "takes one of 'speed', 'frames' and 'curve', not several");
    if (wish.speed && *wish.speed == 0)
        check.fault(
            "speed",
            "'speed' must not be 0; to hold a frame, state a curve such as [[1, 7], [24, 7]]");
    if (wish.start && !wish.curve.empty())
        check.fault("start", "a curve says itself which frame is the first; leave 'start' out");
    for (std::size_t n = 0; n < wish.curve.size(); ++n)
        if (wish.curve[n].size() != 2)
            return check.fault("curve", "a point of 'curve' is [frame, frame of the source]");
        else if (std::abs(wish.curve[n][0]) > farthest_frame)
            return check.fault("curve", fmt::format("{:g} can't number a frame; {:g} is the last",
                                                    wish.curve[n][0], farthest_frame));
        else if (n > 0 && wish.curve[n][0] <= wish.curve[n - 1][0])
            return check.fault("curve",
                               fmt::format("the frames of 'curve' must rise, but {:g} follows {:g}",
                                           wish.curve[n][0], wish.curve[n - 1][0]));
}

}  // namespace fluidcarve
