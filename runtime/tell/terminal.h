#pragma once

#include <string>

namespace fluidcarve {

/// Whether stderr is a terminal and the environment variable NO_COLOR is not set.
bool coloured_terminal();

/// Prints a line to stderr. On a coloured terminal, a first word `failed:`, `warning:` or `done:` is highlighted.
void tell(const std::string& text);

}  // namespace fluidcarve
