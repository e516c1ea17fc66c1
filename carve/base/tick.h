#pragma once

#include <functional>

namespace fluidcarve {

/// Takes the progress of the work, 0 to 1. Called a few times a second, from several threads at
/// once; stops the work by throwing.
using Tick = std::function<void(double fraction)>;

}  // namespace fluidcarve
