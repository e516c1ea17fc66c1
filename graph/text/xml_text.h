#pragma once

#include <string>

namespace fluidcarve {

/// Escapes a text for XML and HTML, between tags or in double quotes. Control characters become
/// spaces.
std::string xml_text(const std::string& text);

}  // namespace fluidcarve
