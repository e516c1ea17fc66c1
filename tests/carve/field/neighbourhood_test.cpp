#include "carve/field/neighbourhood.h"
#include "carve/field/box_mean.h"
#include "carve/field/filter.h"
#include "carve/field/stencil.h"

#include <openvdb/tools/Filter.h>

#include <catch2/catch.hpp>

#include <cstring>
#include <random>

using namespace fluidcarve;
using openvdb::Coord;
using openvdb::CoordBBox;

namespace {

/// Values with holes, inactive values, active and inactive tiles, around the origin.
openvdb::FloatGrid::Ptr ragged(unsigned seed) {
    std::mt19937 random(seed);
    auto out = openvdb::FloatGrid::create(0.25f);
    out->fill(CoordBBox(Coord(8, 8, 8), Coord(23, 15, 15)), 3.5f, true);
    out->fill(CoordBBox(Coord(-24, -8, -8), Coord(-17, -1, -1)), -2.0f, false);
    auto values = out->getAccessor();
    for (auto at = CoordBBox(Coord(-13), Coord(14)).begin(); at; ++at) {
        const auto value = static_cast<float>(random() % 1000) / 100;
        if (random() % 3 > 0) values.setValueOn(*at, value);
        else if (random() % 2 > 0) values.setValueOff(*at, value);
    }
    return out;
}

bool same_bits(const openvdb::FloatGrid& a, const openvdb::FloatGrid& b) {
    if (!a.tree().hasSameTopology(b.tree())) return false;
    auto other = b.getConstAccessor();
    for (auto value = a.cbeginValueAll(); value; ++value) {
        const float there = other.getValue(value.getCoord()), here = *value;
        if (std::memcmp(&here, &there, sizeof here) != 0) return false;
    }
    return true;
}

}  // namespace

TEST_CASE("a neighbourhood reads as an accessor does, in its leaf and one voxel beyond") {
    const auto grid = ragged(1);
    const auto accessor = grid->getConstAccessor();
    Neighbourhood<openvdb::FloatTree> all;
    for (auto leaf = grid->tree().cbeginLeaf(); leaf; ++leaf) {
        all.move_to(accessor, leaf->origin());
        auto box = leaf->getNodeBoundingBox();
        box.expand(1);
        for (auto at = box.begin(); at; ++at) {
            float there = 0, here = 0;
            const bool on = accessor.probeValue(*at, there);
            REQUIRE(all.probeValue(*at, here) == on);
            REQUIRE(here == there);
        }
    }
}

TEST_CASE("stencils give the same in leaves of few voxels and of many") {
    const auto op = [](const auto& values, const Coord& at) {
        return values.getValue(at.offsetBy(1, -1, 0)) - 2 * values.getValue(at.offsetBy(0, 1, 1));
    };
    const auto grid = ragged(2);
    const auto out = map_stencil<openvdb::FloatGrid>(*grid, 0.0f, op);
    const auto accessor = grid->getConstAccessor();
    std::size_t voxels = 0;
    for (auto value = out->cbeginValueOn(); value; ++value) {
        if (!value.isVoxelValue()) continue;
        REQUIRE(*value == op(accessor, value.getCoord()));
        ++voxels;
    }
    CHECK(voxels > 10000);
}

TEST_CASE("the mean of a cube is OpenVDB's, bit for bit") {
    for (const int width : {1, 2, 5, 8})
        for (const int iterations : {1, 2, 4}) {
            const auto ours = ragged(3)->deepCopy(), theirs = ours->deepCopy();
            box_mean(ours->tree(), width, iterations, {0, 2, 1});
            openvdb::tools::Filter<openvdb::FloatGrid>(*theirs).mean(width, iterations);
            INFO("width " << width << ", iterations " << iterations);
            CHECK(same_bits(*ours, *theirs));
        }
    const auto grid = ragged(4);
    const auto ours = filtered_field(*grid, FilterMode::gaussian, 2, 1), theirs = grid->deepCopy();
    open_tile_borders(theirs->tree(), 8);
    openvdb::tools::Filter<openvdb::FloatGrid>(*theirs).gaussian(2, 1);
    CHECK(same_bits(*ours, *theirs));
}
