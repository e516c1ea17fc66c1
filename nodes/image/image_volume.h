#pragma once

#include "nodes/image/image.h"
#include "nodes/payloads.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// A picture as a volume: a float grid for each channel, pixel `(x, y)`, y up, at voxel `(x, y, 0)`, voxel size 1. The pixels of
/// both windows are active, also those that are 0; the picture's lower left corner is voxel `(0, 0, 0)`. Attributes are the
/// volume's metadata, their names behind `image:`; how deep a channel was is its grid's metadata.
Volume volume_of(const Image& image);

/// Bytes of memory that a picture and its volume take.
std::uint64_t bytes_as_volume(const Image& header);

/// What is to become of a volume.
struct ImageWish {
    const ImageFormat* format = nullptr;
    std::optional<std::string> depth;                  ///< of all channels; nothing: as they were read
    std::optional<std::vector<std::string>> channels;  ///< nothing: all grids
};

/// The picture that a volume holds: the box of its active voxels, which lie in one plane z. If that is not the box that was
/// read, the picture grows and shrinks with it. What is inactive in the box is as its grid says.
/// @param warn  told what is lost
/// @throws Failure naming what the format can't hold, and the remedy; if the grids are no channels
Image image_of(const Volume& volume, const ImageWish& wish, const std::function<void(const std::string&)>& warn);

}  // namespace fluidcarve
