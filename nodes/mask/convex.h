#pragma once

#include "nodes/payloads.h"

#include <functional>
#include <string>

namespace fluidcarve {

/// A convex shape in world space.
struct Convex {
    std::string name;                                    ///< of the mask, and in messages: "box"
    openvdb::BBoxd bounds;                               ///< holds all of it
    std::function<bool(const openvdb::Vec3d&)> holds;    ///< whether a point lies in it
    std::function<bool(const openvdb::BBoxd&)> touches;  ///< false only if it has no point in the box
};

/// The voxels whose centres lie in a shape, whole blocks of them as tiles, so that a large shape costs what its border costs.
/// @param like  gives the transform
/// @throws Failure naming `like` if its transform is not linear, or the shape is too large even so
MaskGrid::Ptr convex_mask(const openvdb::GridBase& like, const Convex& shape);

/// How far beyond its border a shape still holds a voxel's centre, world units: the rounding of a place that was typed.
double convex_slack(const openvdb::GridBase& like);

}  // namespace fluidcarve
