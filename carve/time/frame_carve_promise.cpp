#include "carve/time/frame_carve_promise.h"

#include "carve/base/failure.h"
#include "carve/base/frame_set.h"
#include "carve/time/sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

namespace fluidcarve {

std::vector<int> FrameCarvePromise::left(const Auto<Count>& used,
                                         const std::vector<int>& frames) const {
    const int size = static_cast<int>(frames.size()), all = count.of(size),
              most = used ? std::abs(used->of(size)) : std::abs(all),
              by = paired ? 0 : std::clamp(all, -most, most);
    if (size + by < 1)
        throw Failure(
            fmt::format("count {} takes all of {} frames; some must stay", to_text(count), size));
    return even_frames(frames.front(), step_of(frames), static_cast<double>(size) + by);
}

}  // namespace fluidcarve
