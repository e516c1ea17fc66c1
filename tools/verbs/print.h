#pragma once

#include "graph/text/problem.h"
#include "runtime/tell/exit_codes.h"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace fluidcarve {

/// Prints a result to stdout.
void print(const std::string& text);
/// The same with a JSON value, indented.
void print_json(const nlohmann::ordered_json& json);
/// Prints a message to stderr.
void complain(const std::string& text);
/// Prints a message to stderr, as a line. @return `code`
int end_with(const std::string& message, int code = exit_code::usage);
/// Prints problems of a pipeline to stderr, a line each. @return exit_code::usage
int end_with(const Problems& problems);

}  // namespace fluidcarve
