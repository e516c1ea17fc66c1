#include "formats/image/image_channels.h"
#include "nodes/preview/render.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace fluidcarve;
using openvdb::Coord;
using openvdb::CoordBBox;

namespace {

/// Two columns of a picture, each of one value.
FloatGrid::Ptr channel(const std::string& name, const std::string& depth, float left, float right) {
    auto out = FloatGrid::create();
    out->setName(name);
    out->denseFill(CoordBBox(Coord(0), Coord(0, 1, 0)), left, true);
    out->denseFill(CoordBBox(Coord(1, 0, 0), Coord(1, 1, 0)), right, true);
    out->insertMeta(depth_key, openvdb::StringMetadata(depth));
    return out;
}

std::vector<Colour> pixels(const std::vector<FloatGrid::Ptr>& channels, double gain) {
    Volume volume;
    for (const auto& each : channels) volume.grids.emplace_back(each);
    const auto scene = scene_of(volume, "before", channels[0]);
    REQUIRE(scene.picture);
    return render(scene, View::z, scene.box(), {0, 0, gain}).picture.pixels;
}

constexpr Colour left{255, 51, 0}, right{0, 102, 255}, white{255, 255, 255}, black{0, 0, 0};

}  // namespace

TEST_CASE("picture scene: a channel of a picture is shown as the picture, in its colours") {
    const std::vector screen{channel("R", "uint8", 1, 0), channel("G", "uint8", 0.2f, 0.4f),
                             channel("B", "uint8", 0, 1)};
    CHECK(pixels(screen, 1) == std::vector{left, right, left, right});
    CHECK(pixels(screen, 4)[0] == Colour{255, 96, 0});
}

TEST_CASE("picture scene: floats are light, and no number is black") {
    const std::vector light{channel("R", "half", 1, NAN),
                            channel("G", "half", std::pow(0.2f, 2.2f), std::pow(0.4f, 2.2f)),
                            channel("B", "half", 0, 1)};
    CHECK(pixels(light, 1) == std::vector{left, right, left, right});
}

TEST_CASE("picture scene: a channel without the others is grey") {
    CHECK(pixels({channel("Y", "uint8", 1, 0)}, 1) == std::vector{white, black, white, black});
}

TEST_CASE("picture scene: a large picture has the means of its pixels, and upright sides") {
    auto tall = FloatGrid::create();
    tall->setName("Y");
    tall->insertMeta(depth_key, openvdb::StringMetadata("float"));
    tall->denseFill(CoordBBox(Coord(0), Coord(0, 399, 0)), 0, true);
    tall->denseFill(CoordBBox(Coord(1, 0, 0), Coord(1, 399, 0)), 1, true);
    tall->denseFill(CoordBBox(Coord(0, 398, 0), Coord(1, 399, 0)), 1, true);
    Volume volume;
    volume.grids.emplace_back(tall);
    const auto scene = scene_of(volume, "before", tall);
    const auto out = render(scene, View::z, scene.box(), {});
    REQUIRE(out.picture.width == 1);
    REQUIRE(out.picture.height == 200);
    CHECK(out.picture.pixels[0] == white);
    CHECK(out.picture.pixels[1] == Colour{186, 186, 186});
}
