#pragma once

#include <string>

namespace fluidcarve {

/// A text as it stands in XML and HTML, between tags or in double quotes; control characters become spaces.
std::string xml_text(const std::string& text);

}  // namespace fluidcarve
