#pragma once

#include <openvdb/openvdb.h>

namespace fluidcarve {

/// Registers OpenVDB's own types, and types that applications add. To be called before grids are
/// read or created by type name; further calls do nothing.
void register_openvdb_types();

/// OpenVDB's type name of point grids.
inline constexpr auto point_grid_type = "Tree_ptdataidx32_5_4_3";
inline bool is_point_grid(const openvdb::GridBase& grid) { return grid.type() == point_grid_type; }

}  // namespace fluidcarve
