#pragma once

#include "carve/seam/seams.h"
#include "carve/seam/window.h"

#include <string>

namespace fluidcarve {

/// The seams of one window.
struct SeamPart {
    Seams::Kind kind = Seams::Kind::remove;
    Window window;         ///< original entries at full size
    bool static_ = false;  ///< each seam is the same in all frames; it is found in the sum of the
                           ///< frames, and the volume does not change
    bool pair = false;     ///< whether the window is `pair_window`
    /// Of the names of its parameters and report entries.
    std::string prefix() const { return pair ? "pair_" : ""; }
};

}  // namespace fluidcarve
