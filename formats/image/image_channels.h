#pragma once

#include "carve/volume/volume.h"
#include "formats/image/image.h"

#include <openvdb/MetaMap.h>
#include <openvdb/Metadata.h>

#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// Metadata of a channel's grid: the depth of its pixels in the file.
inline constexpr auto depth_key = "image_depth";

/// A metadata value of a type, or else `fallback`.
template <class T>
T meta(const openvdb::MetaMap& from, const char* key, const T& fallback) {
    const auto found = from.getMetadata<openvdb::TypedMetadata<T>>(key);
    return found ? found->value() : fallback;
}

/// The grids that become the channels of a picture, in their order.
using Channels = std::vector<VolumeGrid>;

/// How to write a volume as an image.
struct ImageRequest {
    const ImageFormat* format = nullptr;
    std::optional<std::string> depth;  ///< depth of all channels; nothing: as they were read
    /// Grids to write, in this order; nothing: all.
    std::optional<std::vector<std::string>> channels;
};

/// Whether a grid holds the bits of a channel of identifiers.
bool is_identity(const openvdb::GridBase& grid);

std::string names_of(const Channels& channels);

Channels channels_of(const Volume& volume, const ImageRequest& request);

/// Checks that the format can hold these channels. @throws Failure with the remedy
void require_layout(const Channels& channels, const ImageFormat& format);

std::vector<std::string> depths_of(const Channels& channels, const ImageRequest& request);

}  // namespace fluidcarve
