#pragma once

#include <openvdb/openvdb.h>

#include <string>

namespace fluidcarve {

/// Whether a transform has cubic voxels along the world's axes.
bool cubes_along_axes(const openvdb::math::Transform& transform);

/// Whether a transform has cubic voxels, in any orientation.
bool are_cubes(const openvdb::math::Transform& transform);

/// Whether two transforms differ at most by a translation.
bool same_voxels(const openvdb::math::Transform& a, const openvdb::math::Transform& b);

/// A transform in words: "voxels of 0.1 x 0.1 x 0.1, the first at [0, 0, 0]".
std::string place_text(const openvdb::math::Transform& transform);

/// Checks grids that are combined voxel by voxel.
/// @param what  the two grids, as the message calls them: "terms 1 and 2"
/// @throws Failure naming both grids, their voxel sizes and origins, if their transforms differ
void require_same_transform(const std::string& what, const openvdb::GridBase& first,
                            const openvdb::GridBase& second);

/// Checks that a grid's voxels have the same size and orientation in all frames of a sequence. The
/// grid's origin may move.
class SameVoxels {
public:
    /// @param what   the grid, as the message calls it: "the energy"
    /// @param frame  frame number
    /// @throws Failure naming both frames and transforms, if the voxels are not those of the first
    ///   frame
    void require(const std::string& what, const openvdb::math::Transform& transform, int frame);
    /// The transform of the first frame; null before the first call of `require`.
    const openvdb::math::Transform::ConstPtr& transform() const { return transform_; }

private:
    openvdb::math::Transform::ConstPtr transform_;
    int frame_ = 0;
};

}  // namespace fluidcarve
