#pragma once

#include <cstddef>

namespace fluidcarve {

/// What the body of a node does in one call.
enum class Phase : std::size_t {
    run,      ///< makes outputs
    digest,   ///< takes what it needs of a frame
    consume,  ///< gathers a frame, or the digest of one
    finish,   ///< works on all that it gathered
};

}  // namespace fluidcarve
