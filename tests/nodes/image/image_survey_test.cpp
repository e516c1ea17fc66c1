#include "formats/file/module.h"
#include "formats/image/image.h"
#include "nodes/energy_image.h"
#include "nodes/image.h"
#include "tests/support/node_bench.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

#include <sys/stat.h>
#include <filesystem>
#include <optional>
#include <utility>

using namespace fluidcarve;
using test::failure_of;
using test::NodeBench;

// What is known of pictures before a run reads them.

TEST_CASE("files that are no images are told before a run, with the reason", "[images]") {
    const Scratch scratch;
    const auto told = [&](const std::string& path) {
        const auto absent = NodeBench(image_read(), "{path: \"" + path + "\"}").survey({1}).absent;
        return absent.empty() ? std::string() : absent.at(1);
    };
    CHECK(told(scratch / "a.png") == scratch / "a.png" + " does not exist");
    CHECK(told(scratch.path()) == scratch.path() + " is not a file");
    REQUIRE(mkfifo((scratch / "pipe.png").c_str(), 0600) == 0);
    CHECK(told(scratch / "pipe.png") ==
          scratch / "pipe.png" + " is a pipe or a device; an image is read from a regular file");
    CHECK(told(scratch.write("a.png", "")) == scratch / "a.png" + " is empty");
    CHECK(told(scratch.write("a.png", "PNG it is not")) ==
          scratch / "a.png" + " is not an image in a supported format: PNG, EXR, JPEG, TIFF");
    // By its bytes; a name that says something else is refused, one that says nothing is not.
    std::filesystem::copy_file(TEST_DATA "/images/chelsea.png", scratch / "b.jpg");
    CHECK(told(scratch / "b.jpg") ==
          scratch / "b.jpg" + " holds PNG, but its name says JPEG; rename it to end in .png");
    CHECK(failure_of([&] {
              NodeBench(image_read(), "{path: " + scratch / "b.jpg" + "}").run({});
          }) == told(scratch / "b.jpg"));
    CHECK(told(scratch.write("b.PNG", Scratch::read(TEST_DATA "/images/chelsea.png"))) == "");
    CHECK(told(scratch.write("b.picture", Scratch::read(TEST_DATA "/images/rocket.jpg"))) == "");
    for (const auto& [name, start] :
         {std::pair("c.png", "\x89PNG\r\n\x1a\n"), std::pair("c.jpeg", "\xff\xd8\xff"),
          std::pair("c.exr", "\x76\x2f\x31\x01")})
        CHECK_THAT(told(scratch.write(name, start)),
                   Catch::StartsWith("cannot read " + scratch / name + ": "));

    // 100000 x 100000 pixels in a header are no reason to ask for forty gigabytes.
    auto bytes = Scratch::read(TEST_DATA "/images/chelsea.png");
    const std::string huge("\0\1\x86\xa0\0\1\x86\xa0", 8);
    bytes.replace(16, 8, huge);
    CHECK(told(scratch.write("huge.png", bytes)) != "");
}

TEST_CASE("a survey says which channels a picture has, and its size as it is seen", "[images]") {
    const Scratch scratch;
    Image image;
    image.format = "tiff";
    image.data = image.display = {0, 0, 7, 4};
    image.channels = {{"R", "uint8"}, {"G", "uint8"}, {"B", "uint8"}};
    image.pixels.assign(7 * 4 * 3, 0.2f);
    // Turned by a quarter.
    const int orientation = 6;
    image.attributes = {
        {"Orientation", "int",
         std::string(reinterpret_cast<const char*>(&orientation), sizeof orientation)}};
    load_module<ImageModule>("images").write(scratch / "a.tif", image, 95);
    const auto said =
        NodeBench(image_read(), "{path: " + scratch / "a.tif" + ", channels: {red: R}}")
            .survey({3})
            .delivered;
    const auto& volume = said.at({3, "volume"});
    CHECK(volume.grids == std::vector<std::string>{"R", "G", "B"});
    CHECK(volume.pixels == std::array{4, 7});
    CHECK(said.at({3, "red"}).grids == std::vector<std::string>{"R"});
    CHECK(said.at({3, "red"}).pixels == std::array{4, 7});
}

TEST_CASE("a channel that no reader has is told before the run", "[images]") {
    const std::map<std::string, SurveyedFacts> source{
        {"source", {std::vector<std::string>{"R", "G", "B"}, std::nullopt}}};
    using Told = std::map<int, std::string>;
    for (const auto& type : {image_write(), energy_image()}) {
        const auto told = [&](const std::string& channels) {
            return NodeBench(type, "{channels: " + channels + "}").survey({3, 4}, source).absent;
        };
        CHECK(told("[R, Q]") == Told{{3, "there is no channel 'Q'; there are R, G, B"}});
        CHECK(told("[B]").empty());
        CHECK(told("auto").empty());
    }
}
