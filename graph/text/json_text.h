#pragma once

#include "formats/file/input_file.h"

#include <nlohmann/json.hpp>

#include <string>

namespace fluidcarve {

/// A JSON value as valid UTF-8: invalid bytes, as in names of files, become U+FFFD.
/// @param indent  spaces per level; below 0: one line
template <class Json>
std::string json_text(const Json& json, int indent = -1) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

/// The content of a file that the program wrote itself (text_of_own_file); discarded if it is no
/// JSON.
inline nlohmann::ordered_json json_of_own_file(const std::string& path) {
    return nlohmann::ordered_json::parse(text_of_own_file(path), nullptr, false);
}

/// Whether an object read from a file has a value of a type: `has(job, "name", &Json::is_string)`.
inline bool has(const nlohmann::ordered_json& object, const char* name,
                bool (nlohmann::ordered_json::*is)() const noexcept) {
    return object.contains(name) && (object[name].*is)();
}

}  // namespace fluidcarve
