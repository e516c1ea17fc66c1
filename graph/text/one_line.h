#pragma once

#include <string>

namespace fluidcarve {

/// Makes foreign text safe to print on one line of a terminal: control characters become spaces.
std::string one_line(std::string text);

}  // namespace fluidcarve
