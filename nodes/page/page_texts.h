#pragma once

#include <map>
#include <string_view>

namespace fluidcarve {

/// The files of nodes/page/ that a page is made of, by name: page.html, page.css, and the scripts.
/// Compiled into the program.
const std::map<std::string_view, std::string_view>& page_texts();

}  // namespace fluidcarve
