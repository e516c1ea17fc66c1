#pragma once

#include "carve/base/values.h"

#include <vector>

namespace fluidcarve {

/// What seams of frames do to a sequence, as far as it is known before they are found.
struct FramesCarved {
    Count count;          ///< of frames: removed below 0, else inserted
    bool paired = false;  ///< what leaves comes back in another window

    /// The frames that the carve leaves, numbered on from the first.
    /// @param used    number of seams of these that are carved, its sign left out; auto: all
    /// @param frames  of the sequence, rising
    /// @throws Failure if all frames would leave, or if frames are missing between others
    std::vector<int> left(const Auto<Count>& used, const std::vector<int>& frames) const;
};

}  // namespace fluidcarve
