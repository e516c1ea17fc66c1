#pragma once

#include <string>

namespace fluidcarve {

/// Makes foreign text safe to print on one line of a terminal: control characters become spaces.
std::string one_line(std::string text);

/// Makes foreign text of several lines safe to print. Line breaks and tabs stay; other control
/// characters become \xNN, so that no file name can move the cursor or change colours.
std::string printable(const std::string& text);

/// Shortens foreign text, which may be as long as a file, for a message: to its first 60 bytes, or
/// fewer where the last would be a part of a UTF-8 character, and "...".
std::string cut_short(const std::string& text);

}  // namespace fluidcarve
