#pragma once

#include "graph/types/node_type.h"
#include "nodes/payloads.h"

#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// Intensity of a picture: 0.2126 R + 0.7152 G + 0.0722 B (Rec. 709) if it has these channels, else the mean of all of its
/// channels but opacity (A, alpha).
/// @param channels  takes the mean of these grids instead
/// @return on the voxels that are active in any of them
/// @throws Failure if there is no such grid, or one is no float grid or has another transform
FloatGrid::Ptr intensity(const Volume& image, const std::optional<std::vector<std::string>>& channels = std::nullopt);

/// Energy of a picture: |dI/dx| + |dI/dy| of its intensity (paper eq. 6; Avidan and Shamir 2007), by central differences, beside
/// voxels that are not active by one-sided ones.
/// @param intensity  in cubic voxels along the world's axes
/// @return energy >= 0, per world unit (a pixel, if read by image.read), on the active voxels of `intensity`
/// @throws Failure naming the grid if its voxels are no cubes or a value is not finite
FloatGrid::Ptr image_energy(const FloatGrid& intensity);

NodeType energy_image();

}  // namespace fluidcarve
