#pragma once

#include "carve/volume/volume.h"

#include <cstdint>

namespace fluidcarve {

/// A frame, as motion is found by it.
struct MovingFrame {
    FloatGrid::ConstPtr shown;      ///< what is looked at: a density or a level set
    VectorGrid::ConstPtr velocity;  ///< collocated; null: none
};

/// How far everything moves from one frame to the next. The velocity says it, but for its scale;
/// what the frames show corrects it: METHOD 12.
/// @param a, b   of one transform, with cubic voxels along the world's axes
/// @param scale  how far a velocity of 1 moves, world units
/// @return displacements at the moment halfway, world units, on the voxels around what is shown; 0
///   beyond
/// @throws Failure as require_dense_fits
VectorGrid::Ptr motion_between(const MovingFrame& a, const MovingFrame& b, double scale,
                               std::uint64_t memory_budget);

/// Root mean square difference of two frames at half size, each moved by its velocity to the moment
/// halfway. It is least at the right scale.
double mismatch(const MovingFrame& a, const MovingFrame& b, double scale,
                std::uint64_t memory_budget);

/// How far a velocity of 1 moves in voxels that show something, root mean square; 0 without any.
double typical_speed(const MovingFrame& frame);

}  // namespace fluidcarve
