#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace fluidcarve {

/// Heads of the table of carved grids.
inline const std::vector<std::string> grid_heads{"grid",    "size",   "mass",
                                                 "highest", "centre", "flicker"};

/// Rows of the table of carved grids, two for each grid: before and after.
/// @param grids  the report's section `grids`, by node and grid (pipelines/FORMATS.md)
std::vector<std::vector<std::string>> grid_rows(const nlohmann::ordered_json& grids);

}  // namespace fluidcarve
