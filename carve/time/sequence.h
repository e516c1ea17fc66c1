#pragma once

#include "carve/base/limits.h"
#include "carve/base/values.h"
#include "carve/stream/volume_stream.h"
#include "carve/time/frame_list.h"
#include "carve/time/motion.h"
#include "carve/volume/volume.h"

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace fluidcarve {

/// A frame of a sequence, with the velocity that goes with it.
struct SequenceFrame {
    Volume volume;
    Ref<VectorGrid> velocity;  ///< null: none
};

/// All frames of a sequence, to be read in any order.
class Sequence {
public:
    /// Adds a frame. @param number  of the frame, above those before
    /// @param velocity  may be null, then in all frames
    void add(const Volume& source, const Ref<VectorGrid>& velocity, int number,
             const Limits& limits);

    const std::vector<int>& numbers() const { return frames_.numbers(); }  ///< rising
    /// Box around the active voxels of all float grids of all frames, in their index space.
    const openvdb::CoordBBox& box() const { return box_; }
    std::size_t size() const { return frames_.size(); }
    bool has_velocity() const { return has_velocity_; }
    /// May be called from many threads at once.
    SequenceFrame at(std::size_t place) const;

private:
    NumberedFrames<Volume> frames_;
    openvdb::CoordBBox box_;
    bool has_velocity_ = false;
};

/// The grid that shows most in two frames: a density or a level set, else the float grid with the
/// most active voxels. Nothing if none has one transform in both.
std::optional<std::pair<FloatGrid::ConstPtr, FloatGrid::ConstPtr>> shown_in(const Volume& a,
                                                                            const Volume& b);
/// The same with the velocities.
std::optional<std::pair<MovingFrame, MovingFrame>> moving_in(const SequenceFrame& a,
                                                             const SequenceFrame& b);

/// Difference between consecutive frame numbers; 1 if there is one frame.
/// @throws Failure if frames are missing between others
int step_of(const std::vector<int>& frames);

}  // namespace fluidcarve
