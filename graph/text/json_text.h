#pragma once

#include <string>

namespace fluidcarve {

/// A JSON value as valid UTF-8: invalid bytes, as in names of files, become U+FFFD.
/// @param indent  spaces per level; below 0: one line
template <class Json>
std::string json_text(const Json& json, int indent = -1) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace fluidcarve
