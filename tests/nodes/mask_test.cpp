#include "graph/problem.h"
#include "nodes/mask/threshold.h"
#include "nodes/mask/weight.h"
#include "tests/support/node_bench.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace fluidcarve;
using fluidcarve::test::NodeBench;
using openvdb::Coord;
using openvdb::CoordBBox;

namespace {

/// 0, 0.1, 0.2 ... along x, active from 0 to 9; an active tile of 5 beside it.
FloatGrid::Ptr ramp() {
    auto grid = FloatGrid::create(0);
    for (int x = 0; x < 10; ++x) grid->tree().setValue({x, 0, 0}, 0.1f * static_cast<float>(x));
    grid->tree().addTile(1, {64, 0, 0}, 5.0f, true);
    return grid;
}

Ref<MaskGrid> box_mask(const CoordBBox& box) {
    auto mask = MaskGrid::create();
    mask->sparseFill(box, true, true);
    return mask;
}

}  // namespace

TEST_CASE("a threshold mask holds the active voxels in the range, tiles as tiles") {
    const auto mask = threshold_mask(*ramp(), 0.35, 0.75);
    CHECK(mask->activeVoxelCount() == 4);
    CHECK(mask->tree().isValueOn({4, 0, 0}));
    CHECK(!mask->tree().isValueOn({8, 0, 0}));
    const auto high = threshold_mask(*ramp(), 4, 6);
    CHECK(high->activeVoxelCount() == 512);
    CHECK(high->tree().activeTileCount() == 1);
}

TEST_CASE("a mask keeps its field's transform, and a NaN is in no range") {
    auto field = ramp();
    field->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
    field->tree().setValue({3, 0, 0}, NAN);
    const auto mask = threshold_mask(*field, -1e30, 1e30);
    CHECK(mask->transform() == field->transform());
    CHECK(!mask->tree().isValueOn({3, 0, 0}));
    CHECK(mask->activeVoxelCount() == 9 + 512);
}

TEST_CASE("assigned weights decide between regions, the energy within them, and empty space has its weight too") {
    const auto weighted =
        weighted_energy(*ramp(), {{box_mask({{2, 0, 0}, {30, 7, 7}}), 0.2f}, {box_mask({{5, 0, 0}, {5, 0, 0}}), 0.1f}}, 0.8f, WeightMode::assign);
    const auto at = [&](int x) { return weighted->tree().getValue({x, 0, 0}); };
    CHECK(at(1) == Approx(0.8 * 1.1 / 2));
    CHECK(at(4) == Approx(0.2 * 1.4 / 2));
    CHECK(at(5) == Approx(0.1 * 1.5 / 2));
    CHECK(at(20) == Approx(0.1));
    CHECK(at(64) == Approx(0.8 * 6 / 2));
    CHECK(at(1000) == Approx(0.4));
    CHECK(weighted->background() == Approx(0.4));
    CHECK(weighted->tree().isValueOn({20, 3, 3}));
}

TEST_CASE("multiplied weights scale the energy, and leave empty space at 0") {
    const auto weighted = weighted_energy(*ramp(), {{box_mask({{2, 0, 0}, {30, 7, 7}}), 0.5f}}, 3, WeightMode::multiply);
    CHECK(weighted->tree().getValue({4, 0, 0}) == Approx(0.2));
    CHECK(weighted->tree().getValue({1, 0, 0}) == Approx(0.3));
    CHECK(weighted->background() == 0);
}

TEST_CASE("a mask of another transform is refused by name") {
    auto energy = ramp();
    energy->setName("energy");
    auto mask = MaskGrid::create();
    mask->setName("hot");
    mask->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
    CHECK_THROWS_WITH(
        weighted_energy(*energy, {{mask, 1.0f}}, 1, WeightMode::assign),
        "the energy and mask 1 have different transforms: 'energy' (voxels of 1 x 1 x 1, the first at [0, 0, 0]) and 'hot' (voxels of 0.5 x 0.5 x 0.5, "
        "the first at [0, 0, 0]); resample one onto the other");
}

TEST_CASE("mask nodes refuse parameters that make no sense") {
    CHECK(NodeBench(mask_threshold(), "{}").faults() == "type: needs 'above', 'below' or both\n");
    CHECK(NodeBench(mask_threshold(), "{above: 2, below: 1}").faults() == "above: parameter 'above' is 2, over 'below', 1: no value fits\n");
    CHECK(NodeBench(mask_threshold(), "{above: auto, below: 1}").faults() == "");
    CHECK(NodeBench(mask_weight(), "{weights: [1, 2]}", {{"masks", 1}}).faults() ==
          "weights: parameter 'weights' has 2 numbers for 1 masks; state one for each\n");
}

TEST_CASE("the weight node hands each mask its weight, in order") {
    NodeBench weight(mask_weight(), "{weights: [0.2, 0.1], outside: 0.8}", {{"masks", 2}});
    const auto out = weight.run(
        {{"energy", {Payload(Ref<FloatGrid>(ramp()))}}, {"masks", {Payload(box_mask({{2, 0, 0}, {30, 7, 7}})), Payload(box_mask({{5, 0, 0}, {5, 0, 0}}))}}});
    CHECK(out.at("energy").as<FloatGrid>()->tree().getValue({5, 0, 0}) == Approx(0.1 * 1.5 / 2));
}
