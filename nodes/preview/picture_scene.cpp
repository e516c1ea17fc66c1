#include "nodes/preview/picture_scene.h"

#include "formats/image/image.h"
#include "formats/image/image_channels.h"

#include <algorithm>
#include <cmath>

namespace fluidcarve {

namespace {

/// Sums of the pixels' light.
struct Sum {
    std::array<double, 3> light{};
    int voxels = 0;
};

/// Reads a channel, without making a tree of a plane.
class Channel {
public:
    explicit Channel(const VolumeGrid& grid)
        : pixels_(grid.pixels()),
          grid_(pixels_ ? FloatGrid::create() : openvdb::gridConstPtrCast<FloatGrid>(grid.grid())),
          values_(grid_->getConstAccessor()) {}

    bool is_active(const openvdb::Coord& at) const {
        return pixels_ ? pixels_->box.isInside(at) : values_.isValueOn(at);
    }
    float at(const openvdb::Coord& at) const {
        if (!pixels_) return values_.getValue(at);
        return pixels_->box.isInside(at) ? pixels_->at(at.x(), at.y()) : 0;
    }

private:
    const ChannelPixels* pixels_;
    FloatGrid::ConstPtr grid_;
    FloatGrid::ConstAccessor values_;
};

Colour colour_of(const Sum& sum, double gain) {
    if (sum.voxels == 0) return render_background;
    const auto shown = [&](double light) {
        return screen_byte(on_screen(gain * light / sum.voxels));
    };
    return {shown(sum.light[0]), shown(sum.light[1]), shown(sum.light[2])};
}

}  // namespace

std::optional<PictureScene> picture_in(const Volume& volume, const FloatGrid::ConstPtr& shown) {
    const auto depth = meta(*shown, depth_key, std::string());
    if (depth.empty()) return std::nullopt;
    PictureScene out{{}, depth == "half" || depth == "float" || depth == "double"};
    const auto names = colours_of(volume.given_names());
    for (const auto& each : volume.grids) {
        if (!each.header().isType<FloatGrid>()) continue;
        for (std::size_t n = 0; n < 3; ++n)
            if (each.name() == (names.empty() ? shown->getName() : names[n]))
                out.channels[n] = each;
    }
    for (auto& channel : out.channels)
        if (!channel) channel = VolumeGrid(shown);
    return out;
}

openvdb::CoordBBox PictureScene::box() const {
    openvdb::CoordBBox out;
    for (const auto& each : channels) {
        const auto active = each.active_box();
        if (!active.empty()) out.expand(active);
    }
    return out;
}

RenderedPicture render_picture(const PictureScene& scene, View view, const openvdb::CoordBBox& box,
                               double gain) {
    auto area = face_of(box, view);
    int cell = 1;
    while (std::max(area.size(0), area.size(1)) / cell >= RenderedPicture::most_pixels) cell *= 2;
    const auto cells = in_cells(area, cell);
    for (const int side : {0, 1}) {
        area.first[side] = cells.first[side] * cell;
        area.last[side] = cells.last[side] * cell + cell - 1;
    }
    const int width = cells.size(0), height = cells.size(1);
    std::vector<Sum> sums(static_cast<std::size_t>(width) * height);
    const auto& [red, green, blue] = scene.channels;
    const std::array<Channel, 3> channels{Channel(red), Channel(green), Channel(blue)};
    const auto [right, up] = picture_axes(view);
    for (auto at = box.begin(); at; ++at) {
        if (!channels[0].is_active(*at)) continue;
        const int x = floor_div((*at)[right], cell) - cells.first[0],
                  y = cells.last[1] - floor_div((*at)[up], cell);
        auto& sum = sums[static_cast<std::size_t>(y) * width + x];
        ++sum.voxels;
        for (std::size_t n = 0; n < 3; ++n) {
            const double value = channels[n].at(*at);
            if (!std::isfinite(value)) continue;
            sum.light[n] += scene.linear ? value : of_screen(255 * value);
        }
    }
    RenderedPicture out{area, {width, height, {}}};
    out.picture.pixels.reserve(sums.size());
    for (const auto& sum : sums) out.picture.pixels.push_back(colour_of(sum, gain));
    return out;
}

}  // namespace fluidcarve
