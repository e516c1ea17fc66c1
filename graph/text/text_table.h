#pragma once

#include <string>
#include <vector>

namespace fluidcarve {

/// Formats a text table. The first two columns and the last are aligned left, the others right.
/// @param rows  `[row][column]`; the first row is the head
std::string text_table(const std::vector<std::vector<std::string>>& rows);

}  // namespace fluidcarve
