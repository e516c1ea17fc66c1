#pragma once

#include "carve/volume/volume_grid.h"

#include <openvdb/openvdb.h>

#include <cstddef>
#include <optional>
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

/// Index of the first name that equals `wanted`. If there is none, `name[n]` finds the n-th of
/// that name, from 0 on.
std::optional<std::size_t> find_name(const std::vector<std::string>& names,
                                     const std::string& wanted);

/// All grids of one frame, in the order of their file, and the file's metadata.
struct Volume {
    std::vector<VolumeGrid> grids;
    openvdb::MetaMap metadata;  ///< metadata of the file, not of its grids
    std::string codec;  ///< compression of the file: "none", "zip", "blosc"; empty: not from a file

    /// Index of the grid that find_name() finds.
    std::optional<std::size_t> place(const std::string& name) const;
    /// The grid at that index, or null.
    openvdb::GridBase::ConstPtr find(const std::string& name) const;
    /// Names of the grids; several grids may have one name.
    std::vector<std::string> given_names() const;
    /// Names of the grids; equal names are numbered as in OpenVDB: "density[0]", "density[1]".
    std::vector<std::string> unique_names() const;
    /// Names of the grids for messages: "density, velocity".
    std::string names() const;
};

}  // namespace fluidcarve
