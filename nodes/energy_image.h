#pragma once

#include "carve/volume/volume.h"
#include "graph/types/node_type.h"

#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// Intensity of a picture: 0.2126 R + 0.7152 G + 0.0722 B (Rec. 709) if it has these channels, else
/// the mean of all channels but opacity, depth and identities.
/// @param channels  if given, the intensity is the mean of these grids
/// @throws Failure if a grid is missing or is not a float grid; as image_intensity()
FloatGrid::Ptr intensity(const Volume& image,
                         const std::optional<std::vector<std::string>>& channels = std::nullopt);

/// image_energy() of the same channels. @throws Failure likewise
FloatGrid::Ptr image_energy(const Volume& image,
                            const std::optional<std::vector<std::string>>& channels = std::nullopt);

NodeType energy_image();

}  // namespace fluidcarve
