#include "nodes/image.h"
#include "carve/volume/volume.h"
#include "formats/file/module.h"
#include "formats/image/image_volume.h"
#include "formats/vdb/vdb_file.h"
#include "tests/nodes/image/image_cases.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/node_bench.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

#include <sys/stat.h>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <random>

using namespace fluidcarve;
using test::failure_of;
using test::NodeBench;

namespace {

Image::Attribute text(const std::string& name, const std::string& value) {
    return {name, "string", value};
}

/// What a file says under a name; empty if nothing.
std::string said(const Image& image, const std::string& name) {
    for (const auto& each : image.attributes)
        if (each.name == name) return each.value;
    return {};
}

}  // namespace

TEST_CASE("a pixel is a voxel: y up, 0 at the bottom, whole numbers from 0 to 1, all active",
          "[images]") {
    const Scratch scratch;
    const auto image = random_image("png", channels({"R", "G", "B"}, "uint8"), 19, 11);
    images().write(scratch / "a.png", image, 95);
    const auto volume = read(scratch / "a.png");
    REQUIRE(volume->names() == "R, G, B");
    for (const auto& grid : volume->grids) {
        CHECK(grid->evalActiveVoxelBoundingBox() == openvdb::CoordBBox({0, 0, 0}, {18, 10, 0}));
        CHECK(grid->activeVoxelCount() == 19 * 11);
        CHECK(grid->transform() == openvdb::math::Transform());
    }
    for (int y = 0; y < 11; ++y)
        for (int x = 0; x < 19; ++x)
            REQUIRE(at(*volume, "G", x, y) ==
                    image.pixels[static_cast<std::size_t>(((10 - y) * 19 + x) * 3 + 1)]);
}

TEST_CASE(
    "images come back as they were, to the last bit, in each depth and with each set of channels",
    "[images]") {
    const Scratch scratch;
    const std::vector<std::string> grey{"Y"}, grey_alpha{"Y", "A"}, colour{"R", "G", "B"},
        colour_alpha{"R", "G", "B", "A"}, layers{"R", "G", "B", "A", "Z", "diffuse.R", "diffuse.G"};
    struct Case {
        const char *format, *ending, *depth;
        std::vector<std::vector<std::string>> sets;
    };
    for (const auto& [format, ending, depth, sets] :
         {Case{"png", "png", "uint8", {grey, grey_alpha, colour, colour_alpha}},
          Case{"png", "png", "uint16", {grey, grey_alpha, colour, colour_alpha}},
          Case{"tiff", "tif", "uint8", {grey, colour, colour_alpha}},
          Case{"tiff", "tif", "uint16", {grey, colour, colour_alpha}},
          Case{"tiff", "tiff", "float", {grey, colour, colour_alpha}},
          Case{"openexr", "exr", "half", {grey, colour, colour_alpha, layers}},
          Case{"openexr", "exr", "float", {colour_alpha, layers}}})
        for (const auto& set : sets) {
            INFO(ending << " " << depth << " " << set.size());
            const auto from = scratch / ("a." + std::string(ending)),
                       to = scratch / ("b." + std::string(ending));
            images().write(from, random_image(format, channels(set, depth), 37, 21), 95);
            const auto before = images().read(from, format);
            std::vector<std::string> warnings;
            write(read(from), to, "", &warnings);
            const auto after = images().read(to, format);
            CHECK(warnings.empty());
            CHECK(names(after) == names(before));
            CHECK(after.data == before.data);
            CHECK(after.display == before.display);
            CHECK(after.alpha == before.alpha);
            CHECK(said(after, "DateTime").empty());
            REQUIRE(after.pixels.size() == before.pixels.size());
            CHECK(std::memcmp(after.pixels.data(), before.pixels.data(),
                              before.pixels.size() * sizeof(float)) == 0);
            CHECK(before.pixels == random_image(format, before.channels, 37, 21).pixels);
        }
}

TEST_CASE(
    "an EXR keeps a depth for each channel, and half floats stay half on the way through a VDB",
    "[images]") {
    const Scratch scratch;
    auto image = random_image("openexr",
                              {{"R", "half"}, {"G", "half"}, {"B", "half"}, {"Z", "float"}}, 20, 9);
    images().write(scratch / "a.exr", image, 95);
    write_vdb(scratch / "a.vdb", *read(scratch / "a.exr"));
    const auto kept = std::make_shared<Volume>(read_vdb(scratch / "a.vdb"));
    CHECK(kept->find("R")->saveFloatAsHalf());
    CHECK_FALSE(kept->find("Z")->saveFloatAsHalf());
    write(kept, scratch / "b.exr");
    const auto after = images().read(scratch / "b.exr", "openexr");
    CHECK(names(after) == std::vector<std::string>{"R half", "G half", "B half", "Z float"});
    CHECK(after.pixels == image.pixels);
}

TEST_CASE("what an image says beside its pixels is given back", "[images]") {
    const Scratch scratch;
    auto image = random_image("openexr", channels({"R", "G", "B"}, "half"), 8, 8);
    std::vector<float> camera(16);
    for (std::size_t n = 0; n < 16; ++n) camera[n] = static_cast<float>(n) / 3;
    image.attributes = {text("compression", "zips"),
                        text("shotName", "nobody"),
                        attribute<float>("worldToCamera", "matrix", camera),
                        attribute<int>("shot", "int", {-7}),
                        attribute<float>("focus", "float", {1.25f}),
                        attribute<float>("chromaticities", "float[8]",
                                         {0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f}),
                        attribute<int>("framesPerSecond", "rational2i", {24, 1}),
                        {"multiView", "string[2]", std::string("left\0right\0", 11)}};
    images().write(scratch / "a.exr", image, 95);
    const auto before = images().read(scratch / "a.exr", "openexr");
    // Also on the way through a VDB, whose library knows no matrices of this name.
    write_vdb(scratch / "a.vdb", *read(scratch / "a.exr"));
    write(std::make_shared<Volume>(read_vdb(scratch / "a.vdb")), scratch / "b.exr");
    const auto after = images().read(scratch / "b.exr", "openexr");
    for (const auto& each : image.attributes) {
        INFO(each.name);
        CHECK(said(before, each.name) == each.value);
        CHECK(said(after, each.name) == each.value);
    }

    // A colour profile, texts and pixels that are not square.
    auto photo = random_image("png", channels({"R", "G", "B"}, "uint8"), 8, 8);
    const auto chelsea = images().read(TEST_DATA "/images/chelsea.png", "png");
    photo.attributes = {text("Copyright", "nobody's"), text("oiio:ColorSpace", "sRGB"),
                        attribute<float>("PixelAspectRatio", "float", {2})};
    for (const auto& each : chelsea.attributes)
        if (each.name == "ICCProfile") photo.attributes.push_back(each);
    REQUIRE(photo.attributes.size() == 4);
    for (const std::string name : {"png", "tiff"}) {
        photo.format = name;
        images().write(scratch / ("a." + name), photo, 95);
        write(read(scratch / ("a." + name)), scratch / ("b." + name));
        const auto then = images().read(scratch / ("a." + name), name),
                   now = images().read(scratch / ("b." + name), name);
        for (const auto& each : then.attributes) {
            if (each.name == "tiff:RowsPerStrip") continue;
            INFO(name << ": " << each.name);
            CHECK(said(now, each.name) == each.value);
        }
        CHECK(said(now, "ICCProfile") == photo.attributes.back().value);
        CHECK(said(now, "Copyright") == "nobody's");
    }

    // Where a format has no place for it, it is told.
    std::vector<std::string> warnings;
    write(read(scratch / "a.png"), scratch / "b.exr", "", &warnings);
    CHECK(warnings ==
          std::vector<std::string>{
              "EXR can't hold some attributes of the image, which are left out: ICCProfile"});
}

TEST_CASE("a file that says how it was held is read upright and written as it was", "[images]") {
    const Scratch scratch;
    // Where the stored pixel (0, 0) and the one right of it stand in an upright picture, y up; the
    // file has 5 x 3 pixels.
    const std::vector<std::pair<openvdb::Coord, openvdb::Coord>> places{
        {{0, 2, 0}, {1, 2, 0}}, {{4, 2, 0}, {3, 2, 0}}, {{4, 0, 0}, {3, 0, 0}},
        {{0, 0, 0}, {1, 0, 0}}, {{0, 4, 0}, {0, 3, 0}}, {{2, 4, 0}, {2, 3, 0}},
        {{2, 0, 0}, {2, 1, 0}}, {{0, 0, 0}, {0, 1, 0}}};
    for (int orientation = 1; orientation <= 8; ++orientation) {
        INFO(orientation);
        auto image = random_image("tiff", channels({"Y"}, "uint8"), 5, 3);
        image.attributes = {attribute<int>("Orientation", "int", {orientation})};
        for (std::size_t n = 0; n < image.pixels.size(); ++n)
            image.pixels[n] = static_cast<float>(n + 1) / 255;
        images().write(scratch / "a.tif", image, 95);
        const auto volume = read(scratch / "a.tif");
        const auto& [first, second] = places[static_cast<std::size_t>(orientation - 1)];
        CHECK(at(*volume, "Y", first.x(), first.y()) == image.pixels[0]);
        CHECK(at(*volume, "Y", second.x(), second.y()) == image.pixels[1]);
        CHECK(volume->find("Y")->evalActiveVoxelBoundingBox().max() ==
              (orientation < 5 ? openvdb::Coord(4, 2, 0) : openvdb::Coord(2, 4, 0)));
        write(volume, scratch / "b.tif");
        const auto after = images().read(scratch / "b.tif", "tiff");
        CHECK(after.pixels == image.pixels);
        CHECK(said(after, "Orientation") == image.attributes[0].value);

        // A PNG does not say how it was held.
        write(volume, scratch / "b.png");
        const auto upright = images().read(scratch / "b.png", "png");
        CHECK(upright.data ==
              (orientation < 5 ? Image::Window{0, 0, 5, 3} : Image::Window{0, 0, 3, 5}));
        CHECK(upright.pixels[static_cast<std::size_t>(
                  (upright.data.height - 1 - first.y()) * upright.data.width + first.x())] ==
              image.pixels[0]);
        CHECK(upright.pixels[static_cast<std::size_t>(
                  (upright.data.height - 1 - second.y()) * upright.data.width + second.x())] ==
              image.pixels[1]);
    }
}

TEST_CASE(
    "windows: the picture's corner is the first voxel, and the data window is kept and grows where "
    "pixels moved",
    "[images]") {
    const Scratch scratch;
    auto image = random_image("openexr", channels({"R", "G", "B"}, "half"), 6, 4);
    image.data = {103, 202, 6, 4};
    image.display = {100, 200, 20, 10};
    for (auto& value : image.pixels) value = 0.5f;
    images().write(scratch / "a.exr", image, 95);
    const auto volume = read(scratch / "a.exr");
    CHECK(volume->find("R")->evalActiveVoxelBoundingBox() ==
          openvdb::CoordBBox({0, 0, 0}, {19, 9, 0}));
    CHECK(at(*volume, "R", 3, 7) == 0.5f);
    CHECK(at(*volume, "R", 2, 7) == 0);
    CHECK(at(*volume, "R", 8, 4) == 0.5f);
    CHECK(at(*volume, "R", 8, 3) == 0);
    write(volume, scratch / "b.exr");
    auto after = images().read(scratch / "b.exr", "openexr");
    CHECK(after.data == image.data);
    CHECK(after.display == image.display);
    CHECK(after.pixels == image.pixels);

    auto moved = *volume;
    const auto red = openvdb::gridConstPtrCast<FloatGrid>(volume->find("R"))->deepCopy();
    red->tree().setValue({15, 0, 0}, 1);
    moved.grids[0] = red;
    write(std::make_shared<Volume>(moved), scratch / "b.exr");
    after = images().read(scratch / "b.exr", "openexr");
    CHECK(after.data == Image::Window{103, 202, 13, 8});
    CHECK(after.display == image.display);
    CHECK(after.pixels[static_cast<std::size_t>(7 * 13 + 12) * 3] == 1);

    // Pixels beyond the picture stay there, and a PNG holds the picture only.
    image.data = {95, 200, 30, 10};
    image.pixels.assign(900, 0.25f);
    images().write(scratch / "a.exr", image, 95);
    CHECK(read(scratch / "a.exr")->find("R")->evalActiveVoxelBoundingBox() ==
          openvdb::CoordBBox({-5, 0, 0}, {24, 9, 0}));
    write(read(scratch / "a.exr"), scratch / "b.exr");
    CHECK(images().read(scratch / "b.exr", "openexr").data == image.data);
    std::vector<std::string> warnings;
    write(read(scratch / "a.exr"), scratch / "b.png", ", depth: uint8", &warnings);
    CHECK(warnings ==
          std::vector<std::string>{
              "PNG can't hold pixels outside of the display window; they are left out"});
    CHECK(images().read(scratch / "b.png", "png").data == Image::Window{0, 0, 20, 10});
}

TEST_CASE("a carved image is as narrow as its active voxels, and the picture with it", "[images]") {
    const Scratch scratch;
    auto image = random_image("openexr", channels({"R"}, "half"), 30, 10);
    image.data = {-5, 0, 30, 10};
    image.display = {0, 0, 20, 10};
    images().write(scratch / "a.exr", image, 95);
    auto volume = *read(scratch / "a.exr");
    const auto narrow = openvdb::gridConstPtrCast<FloatGrid>(volume.grids[0])->deepCopy();
    narrow->tree().fill(openvdb::CoordBBox({21, 0, 0}, {24, 9, 0}), 0, false);
    volume.grids[0] = narrow;
    write(std::make_shared<Volume>(volume), scratch / "b.exr");
    const auto after = images().read(scratch / "b.exr", "openexr");
    CHECK(after.data == Image::Window{-5, 0, 26, 10});
    CHECK(after.display == Image::Window{0, 0, 16, 10});
    for (std::size_t y = 0; y < 10; ++y)
        for (std::size_t x = 0; x < 26; ++x)
            REQUIRE(after.pixels[y * 26 + x] == image.pixels[y * 30 + x]);

    // Held on its side, it is the stored height that shrinks.
    auto photo = random_image("tiff", channels({"Y"}, "uint8"), 6, 9);
    photo.attributes = {attribute<int>("Orientation", "int", {6})};
    images().write(scratch / "a.tif", photo, 95);
    auto held = *read(scratch / "a.tif");
    const auto upright = openvdb::gridConstPtrCast<FloatGrid>(held.grids[0])->deepCopy();
    upright->tree().fill(openvdb::CoordBBox({7, 0, 0}, {8, 5, 0}), 0, false);
    held.grids[0] = upright;
    write(std::make_shared<Volume>(held), scratch / "b.tif");
    const auto side = images().read(scratch / "b.tif", "tiff");
    CHECK(side.data == Image::Window{0, 0, 6, 7});
    // The stored first rows are the upright right side, which is gone.
    CHECK(side.pixels == std::vector<float>(photo.pixels.begin() + 12, photo.pixels.end()));
}

TEST_CASE("what a format does not hold is said, with the remedy", "[images]") {
    const Scratch scratch;
    const auto volume = [&](const std::vector<std::string>& names, const std::string& depth) {
        images().write(scratch / "a.exr", random_image("openexr", channels(names, depth), 8, 8),
                       95);
        return read(scratch / "a.exr");
    };
    const auto failure = [&](const Ref<Volume>& from, const std::string& to,
                             const std::string& rest = "") {
        return failure_of([&] { write(from, scratch / to, rest); });
    };
    const auto half = volume({"R", "G", "B"}, "half"),
               opaque = volume({"R", "G", "B", "A"}, "half"),
               deep = volume({"R", "G", "B", "Z"}, "float");
    CHECK(failure(half, "b.png") ==
          "cannot write " + scratch / "b.png" +
              ": PNG holds uint8 or uint16, but the channels are half, half, half; state `depth: "
              "uint16` to round them, or write EXR or TIFF");
    CHECK(failure(opaque, "b.jpg", ", depth: uint8") ==
          "cannot write " + scratch / "b.jpg" +
              ": JPEG holds no opacity: leave it out (`channels: [R, G, B]`), or write PNG, TIFF "
              "or EXR");
    CHECK(failure(deep, "b.png", ", depth: uint8") ==
          "cannot write " + scratch / "b.png" +
              ": PNG holds grey or three colours, each with opacity or without, not R, G, B, Z; "
              "name the channels to write (`channels: [R, G, B]`), or write "
              "EXR or TIFF");
    CHECK(failure(half, "b.exr", ", channels: [R, Q]") ==
          "cannot write " + scratch / "b.exr" + ": there is no channel 'Q'; there are R, G, B");
    for (const auto* name : {"b.png", "b.jpg", "b.exr"})
        CHECK_FALSE(std::filesystem::exists(scratch / name));

    std::vector<std::string> warnings;
    write(opaque, scratch / "b.jpg", ", depth: uint8, channels: [R, G, B]", &warnings);
    CHECK(warnings.size() == 4);
    CHECK(warnings.back() ==
          "JPEG keeps 8 bits and changes values a little each time it is written; PNG, TIFF and "
          "EXR keep them");
    CHECK_THAT(
        warnings.front(),
        Catch::Contains(
            "values of channel 'R' lie outside of 0 to 1, the range of uint8, and were clamped"));

    // Half floats hold infinities, as depth has them where there is nothing; only what is finite
    // can be too large.
    auto far = random_image("openexr", channels({"Z"}, "float"), 4, 2);
    far.pixels = {INFINITY, -INFINITY, 1, 65504, 65510, -1e6f, 0, NAN};
    images().write(scratch / "far.exr", far, 95);
    warnings.clear();
    write(read(scratch / "far.exr"), scratch / "half.exr", ", depth: half", &warnings);
    CHECK(warnings == std::vector<std::string>{"2 values of channel 'Z' lie outside of -65504 to "
                                               "65504, the range of half, and were clamped"});
    const auto cut = images().read(scratch / "half.exr", "openexr").pixels;
    REQUIRE(std::isnan(cut.back()));
    CHECK(std::vector<float>(cut.begin(), cut.end() - 1) ==
          std::vector<float>{INFINITY, -INFINITY, 1, 65504, 65504, -65504, 0});

    const auto faults = [](const std::string& yaml) {
        return NodeBench(image_write(), yaml).faults();
    };
    CHECK(faults("{path: a.gif}") ==
          "path: 'path' must end in one of .png, .exr, .jpg, .jpeg, .tif, .tiff\n");
    CHECK(faults("{path: a.JPG, depth: uint16}") == "depth: JPEG holds uint8, not uint16\n");
    CHECK(faults("{path: a.####.exr, depth: uint8}") ==
          "depth: EXR holds half or float, not uint8\n");
    CHECK(faults("{path: a.png, quality: 90}") ==
          "quality: 'quality' is for JPEG; PNG is lossless\n");
    CHECK(faults("{path: a.jpeg, quality: 90}") == "");
}
