#pragma once

#include "graph/views/value_sources.h"

#include <nlohmann/json.hpp>

#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

/// A value of the report as short text; lists are joined by commas.
std::string plain(const nlohmann::ordered_json& value);

/// A field name as words: "lower_bound" to "lower bound".
std::string words(std::string name);

std::vector<double> numbers(const nlohmann::ordered_json& entry, const std::string& field);

std::string word(const nlohmann::ordered_json& entry, const std::string& field);

std::string values_table(const std::vector<std::pair<std::string, const ValueSource*>>& rows);

}  // namespace fluidcarve
