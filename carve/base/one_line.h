#pragma once

#include <string>

namespace fluidcarve {

/// Makes foreign text safe to print on one line of a terminal: control characters become spaces.
std::string one_line(std::string text);

/// The same for several lines, with tabs: each other control character is shown as \xNN, so that no
/// name that a file has moves the cursor or changes colours.
std::string printable(const std::string& text);

}  // namespace fluidcarve
