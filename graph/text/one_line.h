#pragma once

#include <string>

namespace fluidcarve {

/// A text that others wrote, fit for a terminal: without line ends and commands.
std::string one_line(std::string text);

}  // namespace fluidcarve
