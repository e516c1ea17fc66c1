#pragma once

#include "carve/base/region.h"
#include "carve/volume/stored_form.h"
#include "formats/vdb/vdb_file.h"

#include <optional>

namespace fluidcarve {

/// The region of the active voxels of grids, by the statistics in their headers.
class HeaderRegion {
public:
    /// Adds a grid, in one frame.
    void add(const VdbHeader::Entry& grid, const Placement& placement);
    /// One box around the voxels of all grids, no box if there are none; nothing if a grid has no
    /// such statistics, or a transform that is not linear.
    std::optional<Region> region() const;

private:
    bool known_ = true;
    openvdb::BBoxd box_;  ///< world units
};

}  // namespace fluidcarve
