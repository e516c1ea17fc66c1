#pragma once

#include "carve/base/values.h"

#include <vector>

namespace fluidcarve {

/// The effect of seams of frames on a sequence, as known before the seams are found.
struct FrameCarvePromise {
    Count count;          ///< of frames: removed below 0, else inserted
    bool paired = false;  ///< removals are matched by insertions in another window

    /// The frames that the carve leaves, numbered on from the first.
    /// @param used    how many of these seams are carved; its sign is ignored; auto: all
    /// @param frames  of the sequence, rising
    /// @throws Failure if no frame would be left, or if frames are missing between others
    std::vector<int> left(const Auto<Count>& used, const std::vector<int>& frames) const;
};

}  // namespace fluidcarve
