#pragma once

#include "carve/base/values.h"
#include "carve/volume/volume.h"

#include <openvdb/openvdb.h>

#include <array>
#include <cstddef>
#include <vector>

namespace fluidcarve {

/// Small images of all frames of a sequence, to compare frames: what is visible, and its momentum.
/// Where no float grid shows anything, points are counted instead.
class Thumbnails {
public:
    /// Adds the next frame.
    /// @param velocity  null: none
    void add(const Volume& volume, const Ref<VectorGrid>& velocity);

    std::size_t size() const { return frames_.size(); }
    /// How much two frames differ in what they show and, if there is a velocity, in its momentum.
    /// About 1 for neighbouring frames.
    double difference(std::size_t a, std::size_t b) const;

private:
    struct Frame {
        openvdb::FloatTree shown;     ///< sums over cubes of 4^3 voxels
        openvdb::Vec3STree momentum;  ///< the same of what is shown times its velocity
    };
    /// Counts the points of a volume, in the voxels of the first point grid added.
    void add_points(const Volume& volume, Frame& to);
    /// Squared difference of two frames: of what they show, and of its momentum.
    std::array<double, 2> squares(const Frame& a, const Frame& b) const;

    std::vector<Frame> frames_;
    openvdb::math::Transform::ConstPtr voxels_;  ///< of points; null: there were none
    std::array<double, 2> typical_{};            ///< sums of the squares of neighbouring frames
};

}  // namespace fluidcarve
