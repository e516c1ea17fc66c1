#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace fluidcarve {

/// Prints a result to stdout.
void print(const std::string& text);
/// The same with a JSON value, indented.
void print_json(const nlohmann::ordered_json& json);
/// Prints a message to stderr.
void complain(const std::string& text);

}  // namespace fluidcarve
