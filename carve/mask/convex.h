#pragma once

#include "carve/volume/volume.h"

#include <functional>
#include <string>

namespace fluidcarve {

/// A convex shape in world space.
struct Convex {
    std::string name;       ///< name of the mask, also in messages: "box"
    openvdb::BBoxd bounds;  ///< contains the whole shape
    std::function<bool(const openvdb::Vec3d&)> holds;  ///< whether a point is in the shape
    /// Whether a box may meet the shape; false only if it certainly does not.
    std::function<bool(const openvdb::BBoxd&)> touches;
};

/// The voxels whose centres lie in a shape. Blocks inside the shape become tiles, so that time and
/// memory grow only with its border.
/// @param like  the mask takes its transform
/// @throws Failure naming `like` if its transform is not linear, or the border has too many voxels
MaskGrid::Ptr convex_mask(const openvdb::GridBase& like, const Convex& shape);

/// Tolerance in world units: voxel centres up to this far outside a shape count as on its border,
/// since typed positions are rounded.
double convex_slack(const openvdb::GridBase& like);

}  // namespace fluidcarve
