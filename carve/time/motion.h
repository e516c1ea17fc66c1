#pragma once

#include "carve/volume/volume.h"

#include <cstdint>

namespace fluidcarve {

/// The parts of a frame by which motion is found.
struct MovingFrame {
    FloatGrid::ConstPtr shown;      ///< the visible grid: a density or a level set
    VectorGrid::ConstPtr velocity;  ///< collocated; null: none
};

/// Displacements of content from one frame to the next (METHOD 12): the velocity times `scale`,
/// corrected by what both frames show.
/// @param a, b   of one transform, with cubic voxels along the world's axes
/// @param scale  displacement at a velocity of 1, world units
/// @return displacements at the moment halfway, world units, on voxels around the visible content;
///   0 beyond
/// @throws Failure as require_dense_fits
VectorGrid::Ptr motion_between(const MovingFrame& a, const MovingFrame& b, double scale,
                               std::uint64_t memory_budget);

/// Root mean square difference of two frames at half size, each moved by its velocity to the moment
/// halfway. It is least at the right scale.
double mismatch(const MovingFrame& a, const MovingFrame& b, double scale,
                std::uint64_t memory_budget);

/// Root mean square speed at the active voxels of the visible grid, in the unit of the velocity; 0
/// without a velocity.
double typical_speed(const MovingFrame& frame);

}  // namespace fluidcarve
