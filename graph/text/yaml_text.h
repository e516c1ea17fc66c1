#pragma once

#include "graph/text/value.h"

#include <string>

namespace fluidcarve {

/// Which letters a text may hold; others are escaped.
enum class Letters { all, ascii };

/// A text as a YAML scalar on one line, in quotes if it needs them.
std::string yaml_scalar(const std::string& text, Letters letters = Letters::all);

/// A value as YAML on one line.
std::string yaml_text(const Value& value, Letters letters = Letters::all);

}  // namespace fluidcarve
