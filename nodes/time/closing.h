#pragma once

#include "nodes/payloads.h"

#include <cstddef>
#include <vector>

namespace fluidcarve {

/// Where and when the end of a loop goes over into what comes before it: a surface in space and time. Each place goes over when both sides differ least
/// there, in a few frames; so all but a few places show one side alone (METHOD 12 "Loops").
class Closing {
public:
    /// @param like    whose space the surface is in
    /// @param frames  of the end that fade, at least 1
    /// @param width   frames in which a place goes over, at least 1, at most `frames`
    /// @param box     of all voxels that show something
    Closing(const FloatGrid& like, std::size_t frames, double width, const openvdb::CoordBBox& box);

    /// Adds the frame at a place among those that fade, and the one into which it fades, in rising order. They must have the transform of `like`.
    void add(const FloatGrid& end, const FloatGrid& before);
    /// Call it when all are added.
    void finish();

    /// Share of what comes before the loop, from 0 to 1.
    /// @param frame  place among the frames that fade
    double share(std::size_t frame, const openvdb::Vec3d& world) const;

private:
    /// Averages with the neighbours along all axes, by weights 1, 2 and 1.
    void smooth(std::vector<float>& values, int times) const;

    openvdb::math::Transform::Ptr space_;
    std::size_t frames_, added_ = 0;
    double width_;
    int shift_ = 2;                           ///< cubes have 2^shift voxels along each axis
    openvdb::Coord low_, size_;               ///< in cubes
    std::vector<float> when_, weight_, all_;  ///< `[x][y][z]`; when_: the moment, from 1 to `frames`, once finished
};

}  // namespace fluidcarve
