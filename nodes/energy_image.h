#pragma once

#include "carve/volume/volume.h"
#include "graph/types/node_type.h"

#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// Intensity of a picture: 0.2126 R + 0.7152 G + 0.0722 B (Rec. 709) if it has these channels, else
/// the mean of all channels except opacity (A, alpha).
/// @param channels  if given, the intensity is the mean of these grids
/// @return intensity in the unit of the channels, active where any channel is
/// @throws Failure if a grid is missing, is not a float grid, or has another transform
FloatGrid::Ptr intensity(const Volume& image,
                         const std::optional<std::vector<std::string>>& channels = std::nullopt);

/// Energy of a picture: |dI/dx| + |dI/dy| of its intensity (paper eq. 6; Avidan and Shamir 2007),
/// by central differences; beside inactive voxels by one-sided differences.
/// @param image     with cubic voxels along the world's axes
/// @param channels  as for intensity()
/// @return energy >= 0, units of the intensity per world unit (one pixel in pictures of
///   image.read), active where any channel is
/// @throws Failure as intensity(); or naming the intensity if its voxels are not cubes along the
///   world's axes, or a value is not finite
FloatGrid::Ptr image_energy(const Volume& image,
                            const std::optional<std::vector<std::string>>& channels = std::nullopt);

NodeType energy_image();

}  // namespace fluidcarve
