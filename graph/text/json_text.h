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
template <class Json = nlohmann::ordered_json>
Json json_of_own_file(const std::string& path) {
    return Json::parse(text_of_own_file(path), nullptr, false);
}

/// Whether a value read from a file is an object that has a value of a type:
/// `has(job, "name", &Json::is_string)`.
template <class Json>
bool has(const Json& object, const char* name, bool (Json::*is)() const noexcept) {
    return object.contains(name) && (object[name].*is)();
}

}  // namespace fluidcarve
