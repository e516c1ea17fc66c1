#pragma once

#include "carve/volume/volume.h"
#include "formats/image/image.h"
#include "formats/image/image_channels.h"

#include <array>
#include <cstdint>
#include <functional>
#include <string>

namespace fluidcarve {

/// Converts a picture to a volume: one float grid per channel, as planes of the picture's own
/// pixels, voxel size 1, the pixel `(x, y)` (y up) at voxel `(x, y, 0)`. The lower left pixel of
/// the display window is voxel `(0, 0, 0)`. All pixels of both windows are active, also zeros.
/// Attributes become metadata of the volume, named `image:NAME`; the depth of a channel becomes
/// metadata of its grid.
Volume volume_of(Image image);

/// Width and height of the picture that a volume shows, turned upright, pixels.
/// @param header  may have no pixels
std::array<int, 2> upright_size(const Image& header);

/// Bytes of memory that the volume of a picture takes. @param header  may have no pixels
std::uint64_t bytes_as_volume(const Image& header);

/// Converts a volume to a picture: the box of its active voxels, which must lie in one plane z. If
/// the box differs from the picture that was read, the display window grows or shrinks with it.
/// Inactive voxels in the box have their stored value.
/// @param warn  receives messages about values that are lost
/// @throws Failure naming what the format can't hold, with the remedy; or if a grid is not a float
///   grid
Image image_of(const Volume& volume, const ImageRequest& request,
               const std::function<void(const std::string&)>& warn);

}  // namespace fluidcarve
