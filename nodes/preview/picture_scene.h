#pragma once

#include "nodes/preview/render.h"

#include <optional>

namespace fluidcarve {

/// The picture that a volume holds: the colours of R, G and B (colours_of), else the shown grid as
/// grey.
/// @param shown  a grid of the volume
/// @return nothing if the grid is no channel of a picture
std::optional<PictureScene> picture_in(const Volume& volume, const FloatGrid::ConstPtr& shown);

/// Renders a picture as it looks on a screen. A pixel is one voxel, or the mean of whole voxels.
/// @param box   index box to show, not empty
/// @param gain  factor of the light
Render render_picture(const PictureScene& scene, View view, const openvdb::CoordBBox& box,
                      double gain);

}  // namespace fluidcarve
