#pragma once

#include <openvdb/openvdb.h>

namespace fluidcarve {

/// Makes OpenVDB know its own types, and those that applications add and that it leaves out. Whoever reads or makes grids of types
/// known by name only calls this first; further calls do nothing.
void register_openvdb_types();

/// OpenVDB's name of the type of grids with points.
inline constexpr auto point_grid_type = "Tree_ptdataidx32_5_4_3";
inline bool is_point_grid(const openvdb::GridBase& grid) { return grid.type() == point_grid_type; }

}  // namespace fluidcarve
