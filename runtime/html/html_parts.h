#pragma once

#include <string>
#include <vector>

namespace fluidcarve {

// Parts that all pages share.

/// An element with text in it.
/// @param open  its name, and its attributes if it has any: `p class="muted"`
std::string element(const std::string& open, const std::string& words);

/// A table that scrolls sideways where it is too wide.
/// @param rows  `[row][column]`; the first cell of a row is its name
std::string wide_table(const std::vector<std::string>& heads,
                       const std::vector<std::vector<std::string>>& rows);

/// The beginning of a page, up to the start of its body. It has no scripts and loads no other
/// files.
std::string page_begin(const std::string& title);

/// A picture that a click shows at full size.
/// @param caption  also the alternative text
/// @param png  the file's bytes
std::string picture_figure(const std::string& caption, const std::string& png);

}  // namespace fluidcarve
