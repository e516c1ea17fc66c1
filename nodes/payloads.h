#pragma once

#include "graph/types/payload.h"

#include <openvdb/openvdb.h>

#include <string>
#include <vector>

namespace fluidcarve {

using FloatGrid = openvdb::FloatGrid;
using VectorGrid = openvdb::Vec3SGrid;
using MaskGrid = openvdb::MaskGrid;

/// Any one grid; float and vector grids convert to it.
struct AnyGrid {
    openvdb::GridBase::ConstPtr grid;
};

/// All grids of one frame, in the order of their file, and what the file says beside them.
struct Volume {
    std::vector<openvdb::GridBase::ConstPtr> grids;
    openvdb::MetaMap metadata;  ///< the file's own
    std::string codec;          ///< as the file was compressed: "none", "zip", "blosc"; empty: not from a file

    /// The first grid of this name, or null.
    openvdb::GridBase::ConstPtr find(const std::string& name) const;
    /// "density, velocity", for messages.
    std::string names() const;
};

}  // namespace fluidcarve
