#pragma once

#include "carve/volume/grid_types.h"

#include <vector>

namespace fluidcarve {

/// A channel of a picture, and its weight in the intensity.
struct WeightedChannel {
    FloatGrid::ConstPtr channel;
    float weight;
};

/// The weighted sum of channels.
/// @param channels  at least one
/// @return intensity in the unit of the channels, active where any channel is
/// @throws Failure if the channels' transforms differ
FloatGrid::Ptr image_intensity(const std::vector<WeightedChannel>& channels);

/// Energy of a picture: |dI/dx| + |dI/dy| of its intensity (paper eq. 6; Avidan and Shamir 2007),
/// by central differences; beside inactive voxels by one-sided differences. The intensity is never
/// stored as a whole.
/// @param channels  with cubic voxels along the world's axes
/// @return energy >= 0, units of the intensity per world unit (one pixel in pictures of
///   image.read), active where any channel is
/// @throws Failure as image_intensity(); or naming the intensity if its voxels are not cubes along
///   the world's axes, or a value is not finite
FloatGrid::Ptr image_energy(const std::vector<WeightedChannel>& channels);

}  // namespace fluidcarve
