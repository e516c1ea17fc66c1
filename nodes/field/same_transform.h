#pragma once

#include <openvdb/openvdb.h>

#include <string>

namespace fluidcarve {

/// Whether the voxels are cubes along the world's axes.
bool cubes_along_axes(const openvdb::math::Transform& transform);

/// "voxels of 0.1 x 0.1 x 0.1, the first at [0, 0, 0]".
std::string place_text(const openvdb::math::Transform& transform);

/// For grids that are combined voxel by voxel.
/// @param what  the two, as the message calls them: "terms 1 and 2"
/// @throws Failure naming both grids, their voxel sizes and where they start, if their transforms differ
void require_same_transform(const std::string& what, const openvdb::GridBase& first, const openvdb::GridBase& second);

/// For a grid that is gathered over a sequence into one space.
class OneTransform {
public:
    /// @param what  the grid, as the message calls it: "the energy"
    /// @throws Failure naming both frames and places, if the transform is not that of the first frame
    void require(const std::string& what, const openvdb::math::Transform& transform, int frame);
    /// That of the first frame; null before it.
    const openvdb::math::Transform::ConstPtr& transform() const { return transform_; }

private:
    openvdb::math::Transform::ConstPtr transform_;
    int frame_ = 0;
};

}  // namespace fluidcarve
