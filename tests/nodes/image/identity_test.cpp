#include "carve/remap/grid.h"
#include "carve/seam/carve_map.h"
#include "formats/file/module.h"
#include "formats/image/image_volume.h"
#include "nodes/energy_image.h"
#include "nodes/image.h"
#include "tests/support/node_bench.h"
#include "tests/support/scratch.h"
#include "tests/support/seams_through.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <set>

using namespace fluidcarve;
using test::NodeBench;

namespace {

const ImageModule& image_module() { return load_module<ImageModule>("images"); }

constexpr int columns_seen = 40, rows_seen = 12;
constexpr float infinite = std::numeric_limits<float>::infinity();

/// A picture with the channels that renderers write beside colours.
Image rendered() {
    Image out;
    out.format = "openexr";
    out.data = out.display = {0, 0, columns_seen, rows_seen};
    out.channels = {{"R", "float"},         {"Z", "float"},         {"ViewLayer.IndexOB.X", "half"},
                    {"layer00.R", "float"}, {"layer00.G", "float"}, {"number", "uint"}};
    out.attributes = {{"cryptomatte/a1b2c3/name", "string", "layer"}};
    const std::array<std::uint32_t, 3> ids{0x3F12AB34, 0x41C0FFEE, 0x7E967699};
    for (int y = 0; y < rows_seen; ++y)
        for (int x = 0; x < columns_seen; ++x) {
            const auto object = static_cast<std::size_t>(x / 5 + y / 4) % 3;
            const std::array pixel{
                0.5f + 0.01f * static_cast<float>(x * y % 7),
                x % 8 < 3 ? infinite : 5.0f + static_cast<float>(x),
                static_cast<float>(object),
                std::bit_cast<float>(ids.at(object)),
                object == 0 ? 1.0f : 0.25f,
                std::bit_cast<float>(0x01020304u + static_cast<std::uint32_t>(object))};
            out.pixels.insert(out.pixels.end(), pixel.begin(), pixel.end());
        }
    return out;
}

/// All values of a channel, as bits.
std::set<std::uint32_t> values_of(const Image& image, const std::string& name) {
    std::set<std::uint32_t> out;
    const auto channel = static_cast<std::size_t>(
        std::ranges::find(image.channels, name, &Image::Channel::name) - image.channels.begin());
    REQUIRE(channel < image.channels.size());
    for (auto n = channel; n < image.pixels.size(); n += image.channels.size())
        out.insert(std::bit_cast<std::uint32_t>(image.pixels[n]));
    return out;
}

Ref<Volume> read_picture(const std::string& path) {
    return NodeBench(image_read(), "{path: " + path + "}").run({}).at("volume").as<Volume>();
}

/// Reads a picture, carves it softly by slanted seams and writes it.
Image carved_picture(const Scratch& scratch, const Image& image) {
    image_module().write(scratch / "a.exr", image, 95);
    const auto volume = read_picture(scratch / "a.exr");
    const auto lattice = make_box(openvdb::Vec3d(0), {columns_seen, rows_seen, 1}, 1.0, {0, 1, 2});
    auto seams = test::no_seams(lattice, Axis::u, Seams::Kind::remove);
    for (int n = 0; n < 8; ++n) {
        std::vector<std::uint16_t> at;
        for (int lateral = 0; lateral < rows_seen; ++lateral)
            at.push_back(static_cast<std::uint16_t>(10 + lateral / 2));
        seams.seams.push_back({at, 0.0});
    }
    Softness soft;
    soft.vertices = 2;
    const CarveMap map(lattice, {std::make_shared<const Seams>(seams)}, 1, std::nullopt,
                       std::vector{soft});
    const auto carved =
        std::make_shared<Volume>(carve_volume(*volume, lattice, map, Interpolation::linear));
    NodeBench(image_write(), "{path: " + (scratch / "b.exr") + "}")
        .run({{"source", {Payload(carved)}}});
    return image_module().read(scratch / "b.exr", "openexr");
}

}  // namespace

TEST_CASE(
    "a soft carve averages colours, and never what names things, and infinite values make no NaN",
    "[images]") {
    const Scratch scratch;
    const auto before = rendered(), after = carved_picture(scratch, before);
    CHECK(after.data.width == columns_seen - 8);
    for (const std::string name : {"ViewLayer.IndexOB.X", "layer00.R", "layer00.G", "number"}) {
        INFO(name);
        CHECK(std::ranges::includes(values_of(before, name), values_of(after, name)));
    }
    CHECK(!std::ranges::includes(values_of(before, "R"), values_of(after, "R")));
    const auto depths = values_of(after, "Z");
    CHECK(depths.contains(std::bit_cast<std::uint32_t>(infinite)));
    CHECK(std::ranges::none_of(
        depths, [](std::uint32_t bits) { return std::isnan(std::bit_cast<float>(bits)); }));
    for (std::size_t c = 0; c < before.channels.size(); ++c) {
        const auto found =
            std::ranges::find(after.channels, before.channels[c].name, &Image::Channel::name);
        REQUIRE(found != after.channels.end());
        CHECK(found->depth == before.channels[c].depth);
    }
}

TEST_CASE("channels that name things are known by name, by type, or by what the file states",
          "[images]") {
    const auto named = [](const std::string& name, const std::string& depth = "float") {
        return is_identity({name, depth}, {});
    };
    for (const auto* const name :
         {"CryptoObject00.R", "uCryptoAsset01.A", "ViewLayer.CryptoMaterial00.b", "IndexMA.X", "id",
          "rgba.objectId", "matID"})
        CHECK(named(name));
    for (const auto* const name : {"R", "Z", "diffuse.G", "width", "ideal.R", "N.X", "void"})
        CHECK(!named(name));
    CHECK(named("R", "uint"));
    CHECK(named("R", "int"));
    CHECK(is_identity({"hero00.R", "float"}, {{"cryptomatte/12ab34f/name", "string", "hero"}}));
}

TEST_CASE(
    "the colours of a picture are found in its layers, plain ones before those of a layer, "
    "Combined before others",
    "[images]") {
    using Names = std::vector<std::string>;
    CHECK(colours_of({"B", "G", "R", "Z"}) == Names{"R", "G", "B"});
    CHECK(colours_of({"diffuse.B", "diffuse.G", "diffuse.R", "ViewLayer.Combined.B",
                      "ViewLayer.Combined.G", "ViewLayer.Combined.R"}) ==
          Names{"ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B"});
    CHECK(colours_of({"beauty.red", "beauty.green", "beauty.blue"}) ==
          Names{"beauty.red", "beauty.green", "beauty.blue"});
    CHECK(colours_of({"CryptoObject00.R", "CryptoObject00.G", "CryptoObject00.B"}).empty());
    CHECK(colours_of({"Y", "Z"}).empty());
}

TEST_CASE("depth and identities have no part in the intensity of a picture", "[images]") {
    auto image = rendered();
    const Scratch scratch;
    image_module().write(scratch / "a.exr", image, 95);
    const auto seen = intensity(*read_picture(scratch / "a.exr"), std::nullopt);
    CHECK(seen->getName() == "intensity of R");
}

TEST_CASE("a window smaller than the picture is not filled up by a carve", "[images]") {
    auto image = rendered();
    image.attributes.clear();
    image.channels = {{"R", "float"}};
    image.pixels.assign(static_cast<std::size_t>(20 * 6), 0.5f);
    image.data = {6, 3, 20, 6};
    const Scratch scratch;
    const auto after = carved_picture(scratch, image);
    CHECK(after.display == Image::Window{0, 0, columns_seen - 8, rows_seen});
    CHECK(after.data.y == 3);
    CHECK(after.data.height == 6);
    CHECK(after.data.width < 20);
}

TEST_CASE(
    "whole numbers of 32 bits keep their depth, whatever depth is stated, and other formats refuse "
    "them",
    "[images]") {
    const Scratch scratch;
    const auto before = rendered();
    image_module().write(scratch / "a.exr", before, 95);
    const auto volume = Payload(read_picture(scratch / "a.exr"));
    NodeBench(image_write(), "{path: " + (scratch / "b.exr") + ", depth: half}")
        .run({{"source", {volume}}});
    const auto after = image_module().read(scratch / "b.exr", "openexr");
    CHECK(values_of(after, "number") == values_of(before, "number"));
    CHECK(std::ranges::find(after.channels, "R", &Image::Channel::name)->depth == "half");
    CHECK_THAT(test::failure_of([&] {
                   NodeBench(image_write(), "{path: " + (scratch / "b.tif") + "}")
                       .run({{"source", {volume}}});
               }),
               Catch::EndsWith("channel 'number' holds whole numbers of 32 bits, which TIFF can't "
                               "keep; name the channels to write, or write EXR"));
}
