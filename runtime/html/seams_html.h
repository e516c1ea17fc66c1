#pragma once

#include <nlohmann/json.hpp>

#include <string>

namespace fluidcarve {

/// What the page says of a set of seams, below its title: a summary, plots of energies and gaps,
/// and a table of all numbers.
/// @param entry  of the report's section `seams` (pipelines/FORMATS.md)
std::string seams_html(const nlohmann::ordered_json& entry);

}  // namespace fluidcarve
