#include "formats/image/image_volume.h"
#include "carve/stream/volume_stream.h"
#include "tests/support/grid_bytes.h"

#include <catch2/catch.hpp>

#include <bit>
#include <cmath>
#include <limits>
#include <sstream>

using namespace fluidcarve;
using openvdb::Coord;
using openvdb::CoordBBox;

namespace {

const CoordBBox box({-3, 5, 6}, {15, 21, 6}), stored({0, 7, 6}, {12, 20, 6});

/// Values of all kinds, the third channel of four, rows from the top down.
VolumeGrid held(const openvdb::GridBase::Ptr& header) {
    constexpr int channels = 4;
    const int width = stored.dim().x(), height = stored.dim().y();
    const auto values = std::make_shared<std::vector<float>>(
        static_cast<std::size_t>(width * height * channels), -1.0f);
    for (int n = 0; n < width * height; ++n)
        (*values)[static_cast<std::size_t>(n * channels + 2)] = 0.1f * static_cast<float>(n);
    (*values)[2] = -0.0f;
    (*values)[6] = std::numeric_limits<float>::infinity();
    ChannelPixels plane{box, stored, nullptr, channels, -width * channels};
    plane.values =
        std::shared_ptr<const float>(values, values->data() + (height - 1) * width * channels + 2);
    header->setName("Z");
    header->insertMeta("depth", openvdb::StringMetadata("float"));
    header->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
    return {header, plane};
}

/// The same grid, voxel by voxel.
FloatGrid::Ptr by_voxel(const VolumeGrid& grid) {
    const auto out = openvdb::gridPtrCast<FloatGrid>(grid.header().copyGridWithNewTree());
    for (auto at = box.begin(); at; ++at)
        out->tree().setValue(*at,
                             stored.isInside(*at) ? grid.pixels()->at((*at).x(), (*at).y()) : 0.0f);
    return out;
}

}  // namespace

TEST_CASE(
    "a picture's channel becomes the tree of its voxels, all active, whatever its place and the "
    "order of its rows") {
    const auto plane = held(FloatGrid::create(0));
    CHECK(plane.pixels()->at(0, 20) == 0);
    CHECK(std::signbit(plane.pixels()->at(0, 20)));
    CHECK(plane.pixels()->at(1, 19) == Approx(0.1f * 14));
    CHECK(test::difference(*plane.grid(), *by_voxel(plane)).empty());
    CHECK(plane.name() == "Z");
    CHECK(plane.bytes() == stored.volume() * sizeof(float));
    CHECK(plane.active_box() == plane.grid()->evalActiveVoxelBoundingBox());

    const auto numbers = held(openvdb::Int32Grid::create(0));
    CHECK(static_cast<const openvdb::Int32Grid&>(*numbers.grid()).tree().getValue({1, 19, 6}) ==
          std::bit_cast<int>(0.1f * 14));
}

TEST_CASE(
    "what was a picture's channel stays one where its voxels fill a rectangle, and is a tree where "
    "they do not") {
    const auto plane = held(FloatGrid::create(0));
    const auto changed = openvdb::gridConstPtrCast<FloatGrid>(plane.grid())->deepCopy();
    changed->tree().setValue({3, 9, 6}, 7);
    const auto again = plane.holding(changed);
    REQUIRE(again.pixels());
    CHECK(again.pixels()->at(3, 9) == 7);
    CHECK(test::difference(*again.grid(), *changed).empty());
    CHECK(VolumeGrid(plane.grid()).holding(changed).pixels() == nullptr);

    const auto hole = changed->deepCopy(), deep = changed->deepCopy(), empty = FloatGrid::create(0),
               vague = FloatGrid::create(1);
    hole->tree().setValueOff({3, 9, 6}, 0);
    deep->tree().setValue({3, 9, 7}, 1);
    vague->tree().setValue({0, 0, 0}, 1);
    for (const auto& other : {hole, deep, empty, vague}) {
        CHECK(plane.holding(other).pixels() == nullptr);
        CHECK(plane.holding(other).grid() == other);
    }
}

TEST_CASE(
    "pictures are kept as planes: what comes back from a file is the same, and one that is cut off "
    "is refused") {
    Volume volume;
    volume.grids = {held(FloatGrid::create(0)), by_voxel(held(FloatGrid::create(0)))};
    std::stringstream file;
    Stored<Volume>::write(volume, file);
    const auto back = Stored<Volume>::read(file);
    REQUIRE(back->grids.size() == 2);
    CHECK(back->grids[0].pixels());
    CHECK(back->grids[1].pixels() == nullptr);
    CHECK(back->grids[0].pixels()->stored == stored);
    for (const auto& grid : back->grids)
        CHECK(test::difference(*grid.grid(), *volume.grids[0].grid()).empty());
    for (std::size_t size = 0; size < file.str().size(); size += 97) {
        std::istringstream part(file.str().substr(0, size));
        CHECK_THROWS(Stored<Volume>::read(part));
    }
}

TEST_CASE(
    "a picture as a volume takes the memory of its values, and only a part of a window is no "
    "more") {
    Image image;
    image.format = "openexr";
    image.data = {3, 2, 20, 10};
    image.display = {0, 0, 64, 48};
    for (const auto* const name : {"R", "G", "B", "Z"}) image.channels.push_back({name, "float"});
    image.pixels.assign(20 * 10 * 4, 0.5f);
    const auto volume = volume_of(image);
    CHECK(Stored<Volume>::bytes(volume) <= 1.3 * 20 * 10 * 4 * sizeof(float));
    CHECK(volume.find("Z")->activeVoxelCount() == 64 * 48);
    CHECK(openvdb::gridConstPtrCast<FloatGrid>(volume.find("Z"))
              ->tree()
              .getValue({3, 48 - 1 - 2, 0}) == 0.5f);
    CHECK(openvdb::gridConstPtrCast<FloatGrid>(volume.find("Z"))
              ->tree()
              .getValue({2, 48 - 1 - 2, 0}) == 0);
}
