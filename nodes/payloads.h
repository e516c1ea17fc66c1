#pragma once

#include "graph/types/payload.h"

#include <openvdb/openvdb.h>

#include <string>
#include <vector>

namespace fluidcarve {

using FloatGrid = openvdb::FloatGrid;
using VectorGrid = openvdb::Vec3SGrid;
using MaskGrid = openvdb::MaskGrid;

/// One grid of any type. Float, vector and mask grids convert to it.
struct AnyGrid {
    openvdb::GridBase::ConstPtr grid;
};

/// All grids of one frame, in the order of their file, and the file's metadata.
struct Volume {
    std::vector<openvdb::GridBase::ConstPtr> grids;
    openvdb::MetaMap metadata;  ///< metadata of the file, not of its grids
    std::string codec;          ///< compression of the file: "none", "zip", "blosc"; empty: not from a file

    /// The first grid of this name, or null.
    openvdb::GridBase::ConstPtr find(const std::string& name) const;
    /// Names of the grids for messages: "density, velocity".
    std::string names() const;
};

}  // namespace fluidcarve
