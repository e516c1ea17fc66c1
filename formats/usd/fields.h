#pragma once

#include "carve/volume/stored_form.h"
#include "carve/volume/volume.h"

#include <string>
#include <vector>

namespace fluidcarve {

/// A grid of a .vdb file, as OpenUSD's schema UsdVol describes it. Texts are the schema's own
/// tokens.
struct UsdField {
    std::string name;        ///< of the grid in the file
    int index = 0;           ///< among the file's grids of this name
    std::string data_type;   ///< "float", "half3"
    std::string grid_class;  ///< "levelSet", "fogVolume", "staggered", "unknown"
    std::string role;  ///< of vectors of three: "None", "Point", "Normal", "Vector"; else empty
};

/// The grids of a .vdb file as fields.
struct UsdFields {
    std::vector<UsdField> fields;       ///< in the order of the file
    Placement placement;                ///< of the file's space in the shot's world, without offset
    std::vector<std::string> left_out;  ///< grids that USD has no type for, such as points, by name
};

/// The fields of the file that vdb.write makes of a volume.
/// @param placement  the placement that the writer undoes; null: that of each grid's reader
/// @throws Failure if grids have different placements: a USD volume has one
UsdFields usd_fields(const Volume& volume, const Placement* placement);

}  // namespace fluidcarve
