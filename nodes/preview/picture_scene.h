#pragma once

#include "carve/volume/volume.h"
#include "nodes/preview/rendered.h"

#include <array>
#include <optional>

namespace fluidcarve {

/// The channels of a picture.
struct PictureScene {
    std::array<VolumeGrid, 3>
        channels;         ///< red, green, blue: floats, planes as the volume has them
    bool linear = false;  ///< whether values are light; else they are sRGB, 0 to 1

    /// Index box of the active voxels of all channels.
    openvdb::CoordBBox box() const;
};

/// The picture that a volume holds: the colours of R, G and B (colours_of), else the shown grid as
/// grey.
/// @param shown  a grid of the volume
/// @return nothing if the grid is no channel of a picture
std::optional<PictureScene> picture_in(const Volume& volume, const FloatGrid::ConstPtr& shown);

/// Renders a picture as it looks on a screen. A pixel is one voxel, or the mean of whole voxels.
/// @param box   index box to show, not empty
/// @param gain  factor of the light
RenderedPicture render_picture(const PictureScene& scene, View view, const openvdb::CoordBBox& box,
                               double gain);

}  // namespace fluidcarve
