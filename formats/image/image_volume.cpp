#include "formats/image/image_volume.h"

#include "carve/base/failure.h"
#include "carve/field/extent.h"
#include "carve/stream/openvdb_types.h"
#include "formats/file/provenance.h"
#include "formats/image/image_channels.h"
#include "formats/image/upright.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <sstream>

namespace fluidcarve {

namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Metadata;
using openvdb::MetaMap;

constexpr auto format_key = "image_format", data_key = "image_data_window",
               display_key = "image_display_window", unassociated = "oiio:UnassociatedAlpha",
               orientation_key = "image:Orientation";

const std::string attribute_prefix = "image:";

/// Convert a type's name between OpenVDB and OpenImageIO. Types that OpenVDB does not know keep
/// their name and bytes.
std::string type_in_vdb(const std::string& type) { return type == "int" ? "int32" : type; }

std::string type_in_image(const std::string& type) { return type == "int32" ? "int" : type; }

Image::Attribute attribute_of(const std::string& name, const Metadata& metadata) {
    std::ostringstream bytes;
    metadata.write(bytes);
    return {name, type_in_image(metadata.typeName()), bytes.str().substr(sizeof(std::uint32_t))};
}

openvdb::Vec4i packed(const Image::Window& window) {
    return {window.x, window.y, window.width, window.height};
}

Image::Window unpacked(const openvdb::Vec4i& window) {
    return {window[0], window[1], window[2], window[3]};
}

/// The largest picture that is written, and the farthest place and largest side of its windows,
/// pixels.
constexpr std::uint64_t most_image_pixels = std::uint64_t{1} << 32;
constexpr int farthest_pixel = 100'000'000;

/// The window of a picture, from a volume's metadata.
/// @throws Failure (input) if pictures can't be as large
Image::Window window_of(const MetaMap& from, const char* key, const Image::Window& fallback) {
    if (!from[key]) return fallback;
    const auto out = unpacked(meta(from, key, packed(fallback)));
    const auto within = [](int at, int least) { return at >= least && at <= farthest_pixel; };
    if (!within(out.x, -farthest_pixel) || !within(out.y, -farthest_pixel) ||
        !within(out.width, 0) || !within(out.height, 0))
        throw Failure(fmt::format("the metadata '{}' states a window of {} x {} pixels at [{}, "
                                  "{}]; {} is the most: remove it",
                                  key, out.width, out.height, out.x, out.y, farthest_pixel),
                      Failure::Kind::input);
    return out;
}

/// @param box  of the voxels or pixels that make a picture of `names`
void require_pixels(const std::string& names, const CoordBBox& box) {
    require_near(names, box);
    if (voxels_in(box) > most_image_pixels)
        throw Failure(
            fmt::format("the picture of {} spans {}; {} pixels are the most: crop the grid", names,
                        span_text(box), most_image_pixels),
            Failure::Kind::input);
}

Image::Window united(const Image::Window& a, const Image::Window& b) {
    const int x = std::min(a.x, b.x), y = std::min(a.y, b.y);
    return {x, y, std::max(a.x + a.width, b.x + b.width) - x,
            std::max(a.y + a.height, b.y + b.height) - y};
}

int orientation_of(const Image& image) {
    for (const auto& attribute : image.attributes)
        if (attribute.name == "Orientation" && attribute.type == "int" &&
            attribute.value.size() == sizeof(int)) {
            int out = 1;
            std::copy_n(attribute.value.data(), sizeof out, reinterpret_cast<char*>(&out));
            return out;
        }
    return 1;
}

/// Index of a pixel in a window's pixels, row by row. @param pixel  a window of one pixel
std::size_t place(const Image::Window& window, const Image::Window& pixel) {
    return static_cast<std::size_t>(pixel.y - window.y) * static_cast<std::size_t>(window.width) +
           static_cast<std::size_t>(pixel.x - window.x);
}

/// Index of a voxel's pixel in a window's pixels.
class PixelPlaces {
public:
    PixelPlaces(const Image::Window& window, const Upright& upright)
        : corner_(upright.voxels(window).min()) {
        const auto at = [&](const Coord& voxel) {
            return static_cast<std::ptrdiff_t>(place(window, upright.window({voxel, voxel})));
        };
        first_ = at(corner_);
        along_x_ = at(corner_.offsetBy(1, 0, 0)) - first_;
        along_y_ = at(corner_.offsetBy(0, 1, 0)) - first_;
    }
    /// @param x, y  of a voxel inside the window
    std::size_t operator()(int x, int y) const {
        return static_cast<std::size_t>(first_ + (x - corner_.x()) * along_x_ +
                                        (y - corner_.y()) * along_y_);
    }
    /// Index of the pixel at the window's lower left voxel, and the steps to its neighbours along x
    /// and y.
    std::ptrdiff_t first() const { return first_; }
    std::ptrdiff_t along_x() const { return along_x_; }
    std::ptrdiff_t along_y() const { return along_y_; }

private:
    Coord corner_;
    std::ptrdiff_t first_, along_x_, along_y_;
};

/// A channel as a grid of a volume, which refers to the image's pixels.
VolumeGrid grid_of(const std::shared_ptr<const Image>& image, std::size_t channel,
                   const Upright& upright, const CoordBBox& box) {
    const auto& [name, depth] = image->channels[channel];
    openvdb::GridBase::Ptr header;
    if (is_identity(image->channels[channel], image->attributes)) {
        header = openvdb::Int32Grid::create(0);
    } else {
        header = FloatGrid::create(0);
        header->setSaveFloatAsHalf(depth == "half");
    }
    header->setName(name);
    header->insertMeta(depth_key, openvdb::StringMetadata(depth));
    ChannelPixels pixels{box, upright.voxels(image->data), nullptr};
    const PixelPlaces places(image->data, upright);
    const auto count = static_cast<std::ptrdiff_t>(image->channels.size());
    pixels.along_x = places.along_x() * count;
    pixels.along_y = places.along_y() * count;
    pixels.values =
        std::shared_ptr<const float>(image, image->pixels.data() + places.first() * count +
                                                static_cast<std::ptrdiff_t>(channel));
    return {header, std::move(pixels)};
}

bool starts_with_any(const std::string& text, std::initializer_list<const char*> starts) {
    return std::ranges::any_of(starts, [&](const char* start) { return text.starts_with(start); });
}

/// The attributes to write to a file of a format: without those that describe the old pixels or
/// another format.
std::vector<Image::Attribute> attributes_for(const Volume& volume, const std::string& format,
                                             bool same_depth) {
    const bool same_format = meta(volume.metadata, format_key, std::string()) == format;
    std::vector<Image::Attribute> out;
    for (auto at = volume.metadata.beginMeta(); at != volume.metadata.endMeta(); ++at) {
        if (!at->first.starts_with(attribute_prefix)) continue;
        auto attribute = attribute_of(at->first.substr(attribute_prefix.size()), *at->second);
        const auto& name = attribute.name;
        if (starts_with_any(name, {"thumbnail", "Exif:PixelXDimension", "Exif:PixelYDimension",
                                   "openexr:chunkCount", "ICCProfile:"}))
            continue;
        if (name.starts_with("oiio:") && name != "oiio:ColorSpace" && name != unassociated &&
            name != "oiio:Gamma" && !(name == "oiio:BitsPerSample" && same_format && same_depth))
            continue;
        if (!same_format &&
            starts_with_any(name, {"compression", "planarconfig", "screenWindow",
                                   "PixelAspectRatio", "png:", "jpeg:", "tiff:", "openexr:"}))
            continue;
        // Formats that do not store the orientation are written upright.
        if (name == "Orientation" && (format == "png" || (format == "openexr" && !same_format)))
            continue;
        // A lossy compression would lose more with each round.
        if (name == "compression" &&
            starts_with_any(attribute.value, {"dwa", "b44", "pxr24", "jpeg", "ccitt"}))
            attribute.value = "zip";
        out.push_back(std::move(attribute));
    }
    return out;
}

float most_of(const std::string& depth) {
    const bool whole = depth.starts_with("uint8") || depth.starts_with("uint16") ||
                       depth.starts_with("int8") || depth.starts_with("int16");
    return depth == "half" ? 65504.0f : whole ? 1.0f : INFINITY;
}

float least_of(const std::string& depth) {
    if (depth == "int8") return -128.0f / 127;
    if (depth == "int16") return -32768.0f / 32767;
    return depth.starts_with("uint") ? 0.0f : -most_of(depth);
}

/// Reads the pixels of a channel from its grid, in some rows of voxels.
template <class GridT>
void read_channel(const GridT& grid, const CoordBBox& voxels, const tbb::blocked_range<int>& rows,
                  int z, const PixelPlaces& places, std::size_t count, float* out) {
    using Value = typename GridT::ValueType;
    const auto values = grid.getConstAccessor();
    for (int y = rows.begin(); y < rows.end(); ++y)
        for (int x = voxels.min().x(), end = x; x <= voxels.max().x(); x = end) {
            end = std::min((x & ~7) + 8, voxels.max().x() + 1);
            const auto* const leaf = values.probeConstLeaf({x, y, z});
            const Value tile = leaf ? Value(0) : values.getValue({x, y, z});
            for (int at = x; at < end; ++at)
                out[places(at, y) * count] = std::bit_cast<float>(
                    leaf ? leaf->getValue(GridT::TreeType::LeafNodeType::coordToOffset({at, y, z}))
                         : tile);
        }
}

/// The same for pixels, which are 0 outside of their box.
void read_pixels(const ChannelPixels& pixels, const CoordBBox& voxels,
                 const tbb::blocked_range<int>& rows, const PixelPlaces& places, std::size_t count,
                 float* out) {
    for (int y = rows.begin(); y < rows.end(); ++y)
        for (int x = voxels.min().x(); x <= voxels.max().x(); ++x)
            out[places(x, y) * count] = pixels.at(x, y);
}

/// Reads the pixels of the data window from the grids.
/// @param z  index coordinate of the plane of pixels
void read_pixels(const Channels& channels, const Upright& upright, int z, Image& out) {
    const auto count = channels.size();
    out.pixels.resize(static_cast<std::size_t>(out.data.width) *
                      static_cast<std::size_t>(out.data.height) * count);
    const auto voxels = upright.voxels(out.data);
    const PixelPlaces places(out.data, upright);
    tbb::parallel_for(tbb::blocked_range<int>(voxels.min().y(), voxels.max().y() + 1, 8),
                      [&](const tbb::blocked_range<int>& rows) {
                          for (std::size_t c = 0; c < count; ++c) {
                              auto* const first = out.pixels.data() + c;
                              const auto read = [&](const auto& grid) {
                                  read_channel(grid, voxels, rows, z, places, count, first);
                              };
                              const auto& header = channels[c].header();
                              if (const auto* const pixels = channels[c].pixels())
                                  read_pixels(*pixels, voxels, rows, places, count, first);
                              else if (header.isType<FloatGrid>())
                                  read(static_cast<const FloatGrid&>(header));
                              else read(static_cast<const openvdb::Int32Grid&>(header));
                          }
                      });
}

/// Multiplies or divides colours by opacity as the format requires: multiplied in EXR, not in PNG;
/// TIFF states it.
void follow_convention(Image& image) {
    if (image.alpha < 0) return;
    const auto apart = std::ranges::find_if(
        image.attributes, [](const auto& each) { return each.name == unassociated; });
    const bool is_apart = apart != image.attributes.end(),
               wants_apart = image.format == "png" || (image.format == "tiff" && is_apart);
    if (is_apart == wants_apart) return;
    const auto count = image.channels.size(), alpha = static_cast<std::size_t>(image.alpha);
    for (std::size_t c = 0; c < count; ++c) {
        const auto& name = image.channels[c].name;
        if (name != "R" && name != "G" && name != "B" && name != "Y") continue;
        for (std::size_t n = 0; n < image.pixels.size(); n += count) {
            const float opacity = image.pixels[n + alpha];
            if (is_apart) image.pixels[n + c] *= opacity;
            else if (opacity != 0) image.pixels[n + c] /= opacity;
        }
    }
    if (is_apart) {
        image.attributes.erase(apart);
    } else {
        const int yes = 1;
        image.attributes.push_back(
            {unassociated, "int", std::string(reinterpret_cast<const char*>(&yes), sizeof yes)});
    }
}

void warn_of_cut(const Image& image, const std::function<void(const std::string&)>& warn) {
    const auto count = image.channels.size();
    for (std::size_t c = 0; c < count; ++c) {
        const auto& [name, depth] = image.channels[c];
        const float least = least_of(depth), most = most_of(depth);
        if (!std::isfinite(most)) continue;
        std::size_t cut = 0;
        for (std::size_t n = c; n < image.pixels.size(); n += count) {
            const auto value = image.pixels[n];
            // Half floats hold infinities and NaN.
            if (depth == "half" && !std::isfinite(value)) continue;
            cut += value >= least && value <= most ? 0 : 1;
        }
        if (cut > 0)
            warn(
                fmt::format("{} values of channel '{}' lie outside of {:g} to {:g}, the range of "
                            "{}, and were clamped",
                            cut, name, least, most, depth));
    }
}

/// The smallest window that contains `least` and all pixels that are not 0.
/// @param least  nothing: no pixel need be in it
std::optional<Image::Window> around_content(const Image& image,
                                            std::optional<Image::Window> least) {
    auto out = least;
    const auto count = image.channels.size();
    for (int y = image.data.y; y < image.data.y + image.data.height; ++y)
        for (int x = image.data.x; x < image.data.x + image.data.width; ++x) {
            const auto* const pixel = image.pixels.data() + place(image.data, {x, y, 1, 1}) * count;
            if (std::any_of(pixel, pixel + count, [](float value) { return value != 0; }))
                out = out ? united(*out, {x, y, 1, 1}) : Image::Window{x, y, 1, 1};
        }
    return out;
}

/// Changes an image's data window. New pixels are 0.
void reframe(Image& image, const Image::Window& to) {
    if (image.data == to) return;
    const auto count = image.channels.size();
    std::vector<float> pixels(
        static_cast<std::size_t>(to.width) * static_cast<std::size_t>(to.height) * count, 0.0f);
    const auto& from = image.data;
    const int left = std::max(from.x, to.x), right = std::min(from.x + from.width, to.x + to.width);
    for (int y = std::max(from.y, to.y);
         y < std::min(from.y + from.height, to.y + to.height) && left < right; ++y)
        std::copy_n(image.pixels.data() + place(from, {left, y, 1, 1}) * count,
                    static_cast<std::size_t>(right - left) * count,
                    pixels.data() + place(to, {left, y, 1, 1}) * count);
    image.data = to;
    image.pixels = std::move(pixels);
}

/// The voxels that channels hold.
CoordBBox box_of(const Channels& channels) {
    CoordBBox out;
    for (const auto& channel : channels) {
        const auto& grid = channel.header();
        if (const auto* const pixels = channel.pixels()) out.expand(pixels->box);
        else
            out.expand(grid.isType<FloatGrid>() ? active_box(static_cast<const FloatGrid&>(grid))
                                                : grid.evalActiveVoxelBoundingBox());
    }
    return out;
}

/// @param box  of the voxels that make a picture of `names`
void require_picture(const std::string& names, const CoordBBox& box) {
    if (box.empty())
        throw Failure(fmt::format("no voxel of {} is active: there is no pixel to write", names));
    if (box.min().z() != box.max().z())
        throw Failure(fmt::format(
            "the active voxels of {} go from z = {} to {}; an image is one plane of voxels", names,
            box.min().z(), box.max().z()));
    require_pixels(names, box);
}

struct Windows {
    Image::Window display, data;
};

/// The windows that a volume's metadata state, turned to another orientation. Without any, the box
/// is the whole picture.
Windows stated_windows(const MetaMap& metadata, const CoordBBox& box, int orientation) {
    const int held = meta(metadata, orientation_key, 1);
    const auto size = turned_size(held, box.dim().x(), box.dim().y());
    Windows out;
    out.display = window_of(metadata, display_key, {0, 0, size[0], size[1]});
    out.data = window_of(metadata, data_key, out.display);
    if (orientation == held) return out;
    const Upright stored(held, out.display);
    const auto voxels = stored.voxels(out.data);
    out.display = {out.display.x, out.display.y, stored.width(), stored.height()};
    out.data = Upright(orientation, out.display).window(voxels);
    return out;
}

/// A picture that is written.
struct Picture {
    const Channels& channels;
    CoordBBox box;  ///< of its voxels, as if their plane were at z = 0
    int z;          ///< of the plane
};

/// Reads a picture's pixels, and sets the image's windows.
/// @param stated  the windows that it had, with their corner at the voxel `corner`
void read_picture(const Picture& picture, const Windows& stated, const Coord& corner, Image& out) {
    const auto& [display, data] = stated;
    const auto& [channels, box, z] = picture;
    const int orientation = orientation_of(out);
    const Upright read(orientation, display, corner);
    const auto was = read.voxels(united(data, display));
    if (was == box) {
        out.display = display;
        out.data = united(data, display);
        read_pixels(channels, read, z, out);
        if (out.data != data) reframe(out, *around_content(out, data));
        return;
    }
    // The display window grows or shrinks with the box.
    const auto shown = read.voxels(display);
    const CoordBBox now(shown.min() + box.min() - was.min(), shown.max() + box.max() - was.max());
    require_pixels(names_of(channels), now);
    const auto turned = turned_size(orientation, now.dim().x(), now.dim().y());
    out.display = {display.x, display.y, turned[0], turned[1]};
    const Upright upright(orientation, out.display, now.min());
    out.data = upright.window(box);
    read_pixels(channels, upright, z, out);
    // Where the window was smaller than the picture, there was nothing around it.
    if (united(data, display) != data)
        if (const auto content = around_content(out, std::nullopt)) reframe(out, *content);
}

}  // namespace

std::array<int, 2> upright_size(const Image& header) {
    const Upright upright(orientation_of(header), header.display);
    return {upright.width(), upright.height()};
}

Volume volume_of(Image read) {
    // Registers the types of metadata.
    openvdb::initialize();
    const auto held = std::make_shared<const Image>(std::move(read));
    const auto& image = *held;
    const Upright upright(orientation_of(image), image.display);
    const auto box = upright.voxels(united(image.data, image.display));
    Volume out;
    for (std::size_t c = 0; c < image.channels.size(); ++c)
        out.grids.push_back(grid_of(held, c, upright, box));
    for (const auto& [name, type, value] : image.attributes)
        if (!is_provenance(name))
            if (const auto metadata = metadata_of(type_in_vdb(type), value))
                out.metadata.insertMeta(attribute_prefix + name, *metadata);
    out.metadata.insertMeta(format_key, openvdb::StringMetadata(image.format));
    out.metadata.insertMeta(data_key, openvdb::Vec4IMetadata(packed(image.data)));
    out.metadata.insertMeta(display_key, openvdb::Vec4IMetadata(packed(image.display)));
    return out;
}

std::uint64_t bytes_as_volume(const Image& header) {
    const auto all = united(header.data, header.display);
    return header.channels.size() * static_cast<std::uint64_t>(all.width) *
           static_cast<std::uint64_t>(all.height) * sizeof(float);
}

Image image_of(const Volume& volume, const ImageRequest& request,
               const std::function<void(const std::string&)>& warn) {
    const auto channels = channels_of(volume, request);
    require_layout(channels, *request.format);
    const auto depths = depths_of(channels, request);

    Image out;
    out.format = request.format->name;
    bool same_depth = true;
    for (std::size_t c = 0; c < channels.size(); ++c) {
        const auto& grid = channels[c].header();
        out.channels.push_back({grid.getName(), depths[c]});
        same_depth = same_depth && meta(grid, depth_key, std::string()) == depths[c];
        if (const auto name = grid.getName();
            !is_identity(grid) && is_opacity(name) && name.find('.') == std::string::npos)
            out.alpha = static_cast<int>(c);
    }
    const auto box = box_of(channels);
    require_picture(names_of(channels), box);
    out.attributes = attributes_for(volume, out.format, same_depth);

    const CoordBBox flat({box.min().x(), box.min().y(), 0}, {box.max().x(), box.max().y(), 0});
    read_picture({channels, flat, box.min().z()},
                 stated_windows(volume.metadata, flat, orientation_of(out)),
                 volume.metadata[display_key] ? Coord(0) : flat.min(), out);
    if (out.format != "openexr") {
        if (united(out.data, out.display) != out.display)
            warn(
                fmt::format("{} can't hold pixels outside of the display window; they are left out",
                            request.format->shown));
        reframe(out, out.display);
        out.data.x = out.data.y = out.display.x = out.display.y = 0;
    }
    follow_convention(out);
    warn_of_cut(out, warn);
    return out;
}

}  // namespace fluidcarve
