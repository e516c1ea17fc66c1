#pragma once

#include <string>

namespace fluidcarve {

/// Whether stderr is a terminal that colours are welcome on: NO_COLOR is not set.
bool coloured_terminal();

/// A line on stderr. On a coloured terminal its first word stands out if it is `failed:`, `warning:` or `done:`.
void tell(const std::string& text);

}  // namespace fluidcarve
