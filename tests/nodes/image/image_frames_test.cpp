#include "carve/volume/volume.h"
#include "formats/file/module.h"
#include "formats/image/image_volume.h"
#include "formats/vdb/vdb_file.h"
#include "nodes/image.h"
#include "tests/nodes/image/image_cases.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/node_bench.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

#include <sys/stat.h>
#include <cmath>
#include <limits>
#include <random>

using namespace fluidcarve;
using test::failure_of;
using test::NodeBench;

namespace {

void write(const Ref<Volume>& volume, const std::string& path, const std::string& rest = "",
           std::vector<std::string>* warnings = nullptr) {
    struct Host : Context::Host {
        std::vector<std::string>* into = nullptr;
        void warn(const std::string& message) override {
            if (into) into->push_back(message);
        }
    } host;
    host.into = warnings;
    const std::vector<int> frames{1};
    NodeBench node(image_write(), "{path: \"" + path + "\"" + rest + "}");
    REQUIRE(node.faults() == "");
    node.run({{"source", {Payload(volume)}}}, Context(host, frames));
}

}  // namespace

TEST_CASE(
    "from one format to another nothing is lost that need not be, and opacity follows each one's "
    "convention",
    "[images]") {
    const Scratch scratch;
    const auto image = random_image("png", channels({"R", "G", "B"}, "uint16"), 12, 5);
    images().write(scratch / "a.png", image, 95);
    write(read(scratch / "a.png"), scratch / "b.exr");
    CHECK(names(images().read(scratch / "b.exr", "openexr")) ==
          std::vector<std::string>{"R float", "G float", "B float"});
    write(read(scratch / "b.exr"), scratch / "c.png", ", depth: uint16");
    CHECK(images().read(scratch / "c.png", "png").pixels == image.pixels);

    auto clear = random_image("png", channels({"R", "G", "B", "A"}, "uint8"), 1, 1);
    clear.pixels = {1, 128 / 255.0f, 0, 51 / 255.0f};
    images().write(scratch / "a.png", clear, 95);
    write(read(scratch / "a.png"), scratch / "b.exr", ", depth: float");
    const auto multiplied = images().read(scratch / "b.exr", "openexr").pixels;
    CHECK(multiplied[0] == Approx(0.2));
    CHECK(multiplied[1] == Approx(0.2 * 128 / 255));
    CHECK(multiplied[3] == Approx(0.2));
    write(read(scratch / "b.exr"), scratch / "c.png", ", depth: uint8");
    CHECK(images().read(scratch / "c.png", "png").pixels == clear.pixels);
}

TEST_CASE("grids that nodes made are written as deep as the format holds, colours in their order",
          "[images]") {
    const Scratch scratch;
    Volume volume;
    for (const auto* name : {"A", "B", "G", "R"}) {
        const auto grid = FloatGrid::create();
        grid->setName(name);
        grid->tree().setValue({0, 0, 3}, static_cast<float>(name[0] - 'A') / 20);
        volume.grids.push_back(grid);
    }
    write(std::make_shared<Volume>(volume), scratch / "a.tif");
    auto after = images().read(scratch / "a.tif", "tiff");
    CHECK(names(after) == std::vector<std::string>{"R float", "G float", "B float", "A float"});
    CHECK(after.pixels == std::vector<float>{17.0f / 20, 6.0f / 20, 1.0f / 20, 0});
    write(std::make_shared<Volume>(volume), scratch / "a.png", ", channels: [R]");
    CHECK(names(images().read(scratch / "a.png", "png")) == std::vector<std::string>{"Y uint16"});

    const auto grid = FloatGrid::create();
    grid->setName("solid");
    volume.grids = {grid};
    const auto failure = [&] {
        return failure_of([&] { write(std::make_shared<Volume>(volume), scratch / "b.png"); });
    };
    CHECK(failure() == "cannot write " + scratch / "b.png" +
                           ": no voxel of solid is active: there is no pixel to write");
    const auto wide = FloatGrid::create();
    wide->setName("wide");
    for (const int x : {std::numeric_limits<int>::min(), std::numeric_limits<int>::max()})
        wide->tree().setValue({x, 0, 0}, 1);
    volume.grids = {wide};
    CHECK_THAT(failure(),
               Catch::Contains(
                   "4294967296 x 1 x 1 voxels; voxel 1000000000 is the farthest: crop the grid"));
    volume.grids = {grid};
    grid->tree().setValue({0, 0, 0}, 1);
    grid->tree().setValue({0, 0, 4}, 1);
    CHECK(failure() ==
          "cannot write " + scratch / "b.png" +
              ": the active voxels of solid go from z = 0 to 4; an image is one plane of voxels");
    volume.grids = {VectorGrid::create()};
    CHECK_THAT(
        failure(),
        Catch::Contains("is of type Tree_vec3s_5_4_3, but a channel of an image is a float grid"));
}

TEST_CASE("channels are outputs of their own, and frames that are missing are held", "[images]") {
    const Scratch scratch;
    images().write(scratch / "a.03.png",
                   random_image("png", channels({"R", "G", "B", "A"}, "uint8"), 4, 4), 95);
    NodeBench node(image_read(),
                   "{path: " + scratch / "a.##.png" + ", channels: {matte: A}, missing: hold}");
    REQUIRE(node.faults() == "");
    CHECK(node.survey({2, 3, 4}).absent.empty());
    Context::Host host;
    const std::vector<int> frames{2, 3, 4};
    const auto out = node.run({}, Context(host, frames).at(2));
    CHECK(test::difference(*out.at("matte").as<FloatGrid>(),
                           *out.at("volume").as<Volume>()->find("A"))
              .empty());
    NodeBench wrong(image_read(), "{path: " + scratch / "a.##.png" + ", channels: {matte: a}}");
    CHECK(wrong.survey({3}).absent.at(3) ==
          scratch / "a.03.png" + " has no channel 'a'; it has R, G, B, A");
    CHECK(NodeBench(image_read(), "{path: a.png, channels: {volume: A}}").faults() ==
          "channels: image.read already has an output 'volume'; give this one another name\n");
}

TEST_CASE("windows so far off that their pixels can't be counted are refused", "[images]") {
    const Scratch scratch;
    auto image = random_image("openexr", channels({"R"}, "half"), 4, 4);
    image.data.x = 500000000;
    image.display.x = -500000000;
    images().write(scratch / "a.exr", image, 95);
    CHECK_THAT(failure_of([&] { read(scratch / "a.exr"); }),
               Catch::Contains(
                   "its data or display window reaches more than 16777216 pixels from the origin"));
}

TEST_CASE("an image of more pixels than the memory takes is refused", "[images]") {
    NodeBench node(image_read(), "{path: " TEST_DATA "/images/chelsea.png}");
    CHECK(failure_of([&] {
              node.run({}, Context().limits({1 << 20, "."}));
          }) == TEST_DATA
          "/images/chelsea.png has 451 x 300 pixels of 3 channels, which take 0.0 GiB of memory; "
          "--memory allows 0.0");
    // Its window counts, not what the file stores of it.
    const Scratch scratch;
    auto image = random_image("openexr", channels({"R"}, "half"), 1, 1);
    image.display.width = image.display.height = 100'000;
    images().write(scratch / "a.exr", image, 95);
    NodeBench wide(image_read(), "{path: " + (scratch / "a.exr") + "}");
    CHECK_THAT(failure_of([&] {
                   wide.run({}, Context().limits({1 << 30, "."}));
               }),
               Catch::Contains("a.exr has 100000 x 100000 pixels of 1 channels, which take 37.3 "
                               "GiB of memory"));
}

TEST_CASE("an image that is cut off anywhere is told, or the same", "[images]") {
    const Scratch scratch;
    const auto image = random_image("png", channels({"R", "G", "B"}, "uint8"), 61, 47);
    for (const std::string format : {"png", "jpeg", "tiff", "openexr"}) {
        auto whole = image;
        whole.format = format;
        if (format == "openexr") whole.channels = channels({"R", "G", "B"}, "half");
        const auto path = scratch / ("whole." + format);
        images().write(path, whole, 95);
        const auto pixels = images().read(path, format).pixels;
        const auto bytes = Scratch::read(path);
        for (std::size_t n = 1; n <= 40; ++n) {
            const auto cut = scratch.write("cut", bytes.substr(0, bytes.size() * n / 41));
            INFO(format << " cut at " << bytes.size() * n / 41 << " of " << bytes.size());
            const auto told = failure_of([&] {
                if (images().read(cut, format_of_file(cut).name).pixels != pixels)
                    throw std::logic_error("other pixels, and not a word");
            });
            if (!told.empty()) CHECK_THAT(told, Catch::Contains(cut) && !Catch::Contains("\n"));
        }
    }
}

TEST_CASE("the check of a PNG finds any damaged byte, and gives what its header says", "[images]") {
    const Scratch scratch;
    const auto image = random_image("png", channels({"R", "G", "B"}, "uint8"), 31, 23);
    images().write(scratch / "whole.png", image, 95);
    const auto checked = images().checked(scratch / "whole.png", "png");
    CHECK(checked.data == image.data);
    CHECK(checked.channels.size() == 3);
    const auto bytes = Scratch::read(scratch / "whole.png");
    constexpr std::size_t signature = 8;
    for (std::size_t n = signature; n < bytes.size(); n += 1 + n / 40) {
        auto damaged = bytes;
        damaged[n] = static_cast<char>(damaged[n] ^ 1);
        INFO("byte " << n << " of " << bytes.size());
        CHECK_THAT(
            failure_of([&] { images().checked(scratch.write("damaged.png", damaged), "png"); }),
            Catch::Contains("damaged.png"));
    }
}
