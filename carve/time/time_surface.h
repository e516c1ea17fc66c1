#pragma once

#include "carve/time/sequence.h"
#include "carve/volume/volume.h"

#include <cstddef>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

namespace fluidcarve {

/// The surface in space and time at which one run of frames changes into another (METHOD 12
/// "Loops"). Each place changes when both runs differ least there, within a few frames; most
/// places show one run alone.
class TimeSurface {
public:
    /// @param like    the surface is in the space of this grid
    /// @param frames  pairs of frames, at least 1
    /// @param width   frames in which a place changes over, at least 1, at most `frames`
    /// @param box     of all voxels that show something
    TimeSurface(const FloatGrid& like, std::size_t frames, double width,
                const openvdb::CoordBBox& box);

    /// Adds the next pair: a frame of the first run, and the frame into which it changes. They
    /// must have the transform of `like`.
    void add(const FloatGrid& first, const FloatGrid& second);
    /// Call it when all are added.
    void finish();

    /// Share of the second run, from 0 to 1: 0 before the first pair, 1 behind the last.
    /// @param pair  from 0 on
    double share(int pair, const openvdb::Vec3d& world) const;

private:
    /// Averages with the neighbours along all axes, by weights 1, 2 and 1.
    void smooth(std::vector<float>& values, int times) const;

    openvdb::math::Transform::Ptr space_;
    std::size_t frames_, added_ = 0;
    double width_;
    int shift_ = 2;              ///< cubes have 2^shift voxels along each axis
    openvdb::Coord low_, size_;  ///< in cubes
    // Per cube, `[x][y][z]`.
    std::vector<float> when_;    ///< once finished: the moment, from 1 to `frames`
    std::vector<float> weight_;  ///< sum of the weights of moments
    std::vector<float> all_;     ///< sum of squared differences
};

/// The surface at which one run of frames changes into another.
/// @param pairs  indices in the source of a frame of the first run and of the frame into which it
///   changes; at least one pair
/// @param width  as above
/// @param check  called between pairs
/// @return nothing if these frames do not all show a float grid of one transform
std::optional<TimeSurface> surface_between(
    const Sequence& source, const std::vector<std::pair<std::size_t, std::size_t>>& pairs,
    double width, const std::function<void()>& check);

}  // namespace fluidcarve
