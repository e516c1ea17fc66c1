#pragma once

#include <openvdb/openvdb.h>

#include <string>
#include <string_view>

namespace fluidcarve {

/// Registers OpenVDB's own types, and types that applications add. To be called before grids are
/// read or created by type name; further calls do nothing.
void register_openvdb_types();

/// Metadata of a type, from the bytes of its value. A type that OpenVDB does not know keeps its
/// name and bytes.
/// @return nullptr if the type reads another number of bytes
openvdb::Metadata::Ptr metadata_of(const std::string& type, std::string_view value);

/// OpenVDB's type name of point grids.
inline constexpr auto point_grid_type = "Tree_ptdataidx32_5_4_3";
inline bool is_point_grid(const openvdb::GridBase& grid) { return grid.type() == point_grid_type; }

}  // namespace fluidcarve
