#include "nodes/mask.h"
#include "carve/base/failure.h"
#include "carve/field/missed_range.h"
#include "carve/mask/box.h"
#include "carve/mask/combine.h"
#include "carve/mask/dilate.h"
#include "carve/mask/sphere.h"
#include "carve/mask/threshold.h"
#include "carve/mask/weight.h"
#include "tests/support/node_bench.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace fluidcarve;
using fluidcarve::test::failure_of;
using fluidcarve::test::NodeBench;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;
using openvdb::math::Transform;

namespace {

/// 0, 0.1, 0.2 ... along x, active from 0 to 9; an active tile of 5 beside it.
FloatGrid::Ptr ramp() {
    auto grid = FloatGrid::create(0);
    for (int x = 0; x < 10; ++x) grid->tree().setValue({x, 0, 0}, 0.1f * static_cast<float>(x));
    grid->tree().addTile(1, {64, 0, 0}, 5.0f, true);
    return grid;
}

Ref<MaskGrid> voxels_mask(const CoordBBox& box) {
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

TEST_CASE("an empty mask of a threshold says what was wanted and what there was") {
    const auto noted = [](const std::string& yaml, const FloatGrid::Ptr& field) {
        const auto mask = NodeBench(mask_threshold(), yaml)
                              .run({{"field", {Payload(field)}}})
                              .at("mask")
                              .as<MaskGrid>();
        const auto missed = missed_range(*mask);
        return missed ? to_text(*missed) : std::string();
    };
    CHECK(noted("{above: 7}", ramp()) ==
          "mask.threshold marks values from 7, but the field has 0 to 5 only");
    CHECK(noted("{below: -1}", ramp()) ==
          "mask.threshold marks values up to -1, but the field has 0 to 5 only");
    CHECK(noted("{above: 2, below: 3}", FloatGrid::create()) ==
          "mask.threshold marks values from 2 to 3, but the field has no active voxels");
    CHECK(noted("{above: 2}", ramp()).empty());

    const auto foreseen = [](const Region& field) {
        return NodeBench(mask_threshold(), "{above: 2}").foresee({{"field", field}}).warnings;
    };
    CHECK(foreseen({}) ==
          std::vector<std::string>{"by their headers, the files that `field` comes from have no "
                                   "active voxels in any frame: the mask is empty"});
    CHECK(foreseen({{{{0, 0, 0}, {1, 1, 1}}}, {}}).empty());
}

TEST_CASE(
    "assigned weights decide between regions, the energy within them, and empty space has its "
    "weight too") {
    const auto weighted = weighted_energy(
        *ramp(),
        {{voxels_mask({{2, 0, 0}, {30, 7, 7}}), 0.2f}, {voxels_mask({{5, 0, 0}, {5, 0, 0}}), 0.1f}},
        0.8f, WeightMode::assign);
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
    const auto weighted = weighted_energy(*ramp(), {{voxels_mask({{2, 0, 0}, {30, 7, 7}}), 0.5f}},
                                          3, WeightMode::multiply);
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
    CHECK_THROWS_WITH(weighted_energy(*energy, {{mask, 1.0f}}, 1, WeightMode::assign),
                      "the energy and mask 1 have different transforms: 'energy' (voxels of 1 x 1 "
                      "x 1, the first at [0, 0, 0]) and 'hot' (voxels of 0.5 x 0.5 x 0.5, "
                      "the first at [0, 0, 0]); resample one onto the other");
}

TEST_CASE("mask nodes refuse parameters that make no sense") {
    CHECK(NodeBench(mask_threshold(), "{}").faults() == "type: needs 'above', 'below' or both\n");
    CHECK(NodeBench(mask_threshold(), "{above: 2, below: 1}").faults() ==
          "above: parameter 'above', 2, is higher than 'below', 1: no value fits\n");
    CHECK(NodeBench(mask_threshold(), "{above: auto, below: 1}").faults() == "");
    CHECK(NodeBench(mask_weight(), "{weights: [1, 2]}", {{"masks", 1}}).faults() ==
          "weights: parameter 'weights' has 2 numbers for 1 masks; state one for each\n");
}

TEST_CASE("the weight node hands each mask its weight, in order") {
    NodeBench weight(mask_weight(), "{weights: [0.2, 0.1], outside: 0.8}", {{"masks", 2}});
    const auto out = weight.run({{"energy", {Payload(Ref<FloatGrid>(ramp()))}},
                                 {"masks",
                                  {Payload(voxels_mask({{2, 0, 0}, {30, 7, 7}})),
                                   Payload(voxels_mask({{5, 0, 0}, {5, 0, 0}}))}}});
    CHECK(out.at("energy").as<FloatGrid>()->tree().getValue({5, 0, 0}) == Approx(0.1 * 1.5 / 2));
}

namespace {

FloatGrid::Ptr grid_of(const Transform::Ptr& transform) {
    const auto out = FloatGrid::create();
    out->setName("density");
    out->setTransform(transform);
    return out;
}

/// Voxels of 0.5 that are turned, and away from the origin.
Transform::Ptr turned() {
    const auto out = Transform::createLinearTransform(0.5);
    out->preRotate(0.4, openvdb::math::Z_AXIS);
    out->preRotate(-0.3, openvdb::math::X_AXIS);
    out->postTranslate({3, -2, 1});
    return out;
}

/// How many voxels of `box` are in the mask but should not be, or the other way round.
template <class Wanted>
std::size_t wrong(const MaskGrid& mask, const CoordBBox& box, const Wanted& wanted) {
    std::size_t out = 0;
    for (auto at = box.begin(); at; ++at) out += mask.tree().isValueOn(*at) != wanted(*at);
    return out;
}

/// A block with tiles, a lone voxel, and a plate that touches the block at a corner.
MaskGrid::Ptr rugged() {
    const auto out = voxels_mask({{-8, -8, -8}, {9, 9, 8}})->deepCopy();
    out->tree().setValueOn({-13, 3, 3});
    out->sparseFill({{10, 10, 9}, {17, 14, 10}}, true, true);
    out->setName("rugged");
    return out;
}

}  // namespace

TEST_CASE("a box mask holds the voxels whose centres are in the box, its border included") {
    const auto like = grid_of(Transform::createLinearTransform(0.1));
    const auto mask = box_mask(*like, {0.3, -0.7, 0.04}, {1.7, 0.9, 0.16});
    CHECK(mask->activeVoxelCount() == 15 * 17 * 1);
    CHECK(mask->evalActiveVoxelBoundingBox() == CoordBBox({3, -7, 1}, {17, 9, 1}));
    CHECK(mask->transform() == like->transform());
    CHECK(mask->getName() == "box");
    CHECK(box_mask(*like, {0.31, 0.31, 0.31}, {0.39, 0.39, 0.39})->empty());
    CHECK(box_mask(*like, {0.3, 0.3, 0.3}, {0.3, 0.3, 0.3})->activeVoxelCount() == 1);
}

TEST_CASE("a box mask stands in the world, however the grid is turned, stretched or mirrored") {
    auto mirrored = Transform::createLinearTransform(0.5);
    mirrored->preScale({1, -2, 0.5});
    for (const auto& transform : {turned(), mirrored}) {
        const openvdb::BBoxd box({-3, -4, -2.5}, {5, 3, 2});
        const auto mask = box_mask(*grid_of(transform), box.min(), box.max());
        CHECK(wrong(*mask, {{-40, -40, -40}, {40, 40, 40}}, [&](const Coord& at) {
                  return box.isInside(transform->indexToWorld(at));
              }) == 0);
        CHECK(mask->activeVoxelCount() > 1800);
    }
}

TEST_CASE("a large mask is made of tiles") {
    const auto like = grid_of(Transform::createLinearTransform(1));
    const auto box = box_mask(*like, {-256, -256, -256}, {300, 255, 255});
    CHECK(box->activeVoxelCount() == 557ull * 512 * 512);
    CHECK(box->tree().leafCount() == 64 * 64);
    CHECK(box->tree().activeTileCount() == 4 * 4 * 4 + 5 * 64 * 64);
    CHECK(sphere_mask(*like, {0, 0, 0}, 150)->tree().activeTileCount() > 1000);
}

TEST_CASE("a sphere mask has the volume of its sphere") {
    const auto transform = GENERATE(Transform::createLinearTransform(0.05), turned());
    const auto like = grid_of(transform);
    const Vec3d center(3.2, -1.9, 0.7);
    const double radius = 20.5 * like->voxelSize()[0];
    const auto mask = sphere_mask(*like, center, radius);
    CHECK(mask->activeVoxelCount() == Approx(4.0 / 3 * M_PI * std::pow(20.5, 3)).epsilon(0.005));
    auto around = mask->evalActiveVoxelBoundingBox();
    around.expand(3);
    CHECK(wrong(*mask, around, [&](const Coord& at) {
              return (transform->indexToWorld(at) - center).length() <= radius;
          }) == 0);
    CHECK(mask->transform() == *transform);
    CHECK(mask->getName() == "sphere");
}

TEST_CASE("the border of a sphere belongs to it") {
    const auto like = grid_of(Transform::createLinearTransform(0.1));
    CHECK(sphere_mask(*like, {0.1, 0.2, 0.3}, 0.1)->activeVoxelCount() == 7);
    CHECK(sphere_mask(*like, {0.1, 0.2, 0.3}, 0)->activeVoxelCount() == 1);
    CHECK(sphere_mask(*like, {0.15, 0.2, 0.3}, 0.01)->empty());
}

TEST_CASE("masks by place refuse bent grids and sizes that no mask can hold") {
    const auto like = grid_of(Transform::createLinearTransform(0.01));
    CHECK(failure_of([&] {
              box_mask(*like, {-1000, 0, -1000}, {1000, 1000, 1000});
          }) ==
          "the box reaches from voxel [-100000, 0, -100000] to [100000, 100000, 100000] of grid "
          "'density', which is more than a mask can hold; make it "
          "smaller: it needs to cover only the lattice");
    CHECK(failure_of([&] {
              sphere_mask(*like, {1e9, 0, 0}, 1);
          }) ==
          "the sphere reaches from voxel [99999999900, -100, -100] to [100000000100, 100, 100] of "
          "grid 'density', which is more than a mask can hold; make it "
          "smaller: it needs to cover only the lattice");
    CHECK(failure_of([&] {
              box_mask(*grid_of(Transform::createFrustumTransform({{0, 0, 0}, {9, 9, 9}}, 0.5, 3.0,
                                                                  0.1)),
                       {0, 0, 0}, {1, 1, 1});
          }) ==
          "grid 'density' has voxels of varying shape (NonlinearFrustumMap); a box needs voxels of "
          "one shape, as grid.resample makes them");
}

TEST_CASE("union, intersection and difference of masks, voxel by voxel, with tiles") {
    const std::vector<Ref<MaskGrid>> masks{rugged(), voxels_mask({{0, 0, 0}, {15, 7, 15}}),
                                           voxels_mask({{6, -8, 4}, {300, 300, 300}})};
    const auto in = [&](std::size_t n, const Coord& at) { return masks[n]->tree().isValueOn(at); };
    const CoordBBox space({-16, -12, -12}, {24, 24, 24});
    const auto any = combined_mask(masks, MaskMode::any);
    CHECK(wrong(*any, space,
                [&](const Coord& at) { return in(0, at) || in(1, at) || in(2, at); }) == 0);
    CHECK(any->tree().isValueOn({300, 300, 300}));
    CHECK(any->getName() == "union of masks");
    const auto all = combined_mask(masks, MaskMode::all);
    CHECK(wrong(*all, space,
                [&](const Coord& at) { return in(0, at) && in(1, at) && in(2, at); }) == 0);
    CHECK_FALSE(all->tree().isValueOn({300, 300, 300}));
    const auto first = combined_mask(masks, MaskMode::first);
    CHECK(wrong(*first, space,
                [&](const Coord& at) { return in(0, at) && !in(1, at) && !in(2, at); }) == 0);
    const auto rest = combined_mask({masks[2], masks[0]}, MaskMode::first);
    CHECK(rest->activeVoxelCount() ==
          masks[2]->activeVoxelCount() -
              combined_mask({masks[0], masks[2]}, MaskMode::all)->activeVoxelCount());
    CHECK(rest->tree().activeTileCount() > 0);
    CHECK(combined_mask({masks[0]}, MaskMode::first)->activeVoxelCount() ==
          masks[0]->activeVoxelCount());
    CHECK(masks[0]->activeVoxelCount() == rugged()->activeVoxelCount());
}

TEST_CASE("masks of different transforms are not combined") {
    auto moved = voxels_mask({{0, 0, 0}, {1, 1, 1}})->deepCopy();
    moved->setName("moved");
    moved->setTransform(Transform::createLinearTransform(0.5));
    CHECK(failure_of([&] {
              combined_mask({rugged(), rugged(), moved}, MaskMode::any);
          }) ==
          "masks 1 and 3 have different transforms: 'rugged' (voxels of 1 x 1 x 1, the first at "
          "[0, 0, 0]) and 'moved' (voxels of 0.5 x 0.5 x 0.5, the first at "
          "[0, 0, 0]); resample one onto the other");
}

TEST_CASE("a mask dilates and erodes by a cube of voxels, with tiles as without") {
    const auto mask = rugged();
    const auto look = mask->getConstAccessor();
    const auto near = [&](const Coord& at, int reach, bool on) {
        for (auto next = CoordBBox(at.offsetBy(-reach), at.offsetBy(reach)).begin(); next; ++next)
            if (look.isValueOn(*next) == on) return true;
        return false;
    };
    const CoordBBox space({-17, -12, -12}, {21, 18, 14});
    for (const int reach : {1, 3}) {
        CHECK(wrong(*dilated_mask(*mask, reach), space,
                    [&](const Coord& at) { return near(at, reach, true); }) == 0);
        CHECK(wrong(*dilated_mask(*mask, -reach), space,
                    [&](const Coord& at) { return !near(at, reach, false); }) == 0);
    }
    CHECK(dilated_mask(*mask, 2)->getName() == "dilation of rugged");
    CHECK(dilated_mask(*mask, -2)->getName() == "erosion of rugged");
    CHECK(dilated_mask(*mask, 2)->transform() == mask->transform());
    CHECK(dilated_mask(*mask, 0)->activeVoxelCount() == mask->activeVoxelCount());
}

TEST_CASE("a box that is dilated, then eroded as far, is that box again") {
    for (const int reach : {1, 9}) {
        const CoordBBox box({-4, -3, -20}, {130, 127, 140});
        auto wide = box;
        wide.expand(reach);
        const auto dilated = dilated_mask(*voxels_mask(box), reach);
        CHECK(dilated->activeVoxelCount() == wide.volume());
        CHECK(dilated->evalActiveVoxelBoundingBox() == wide);
        const auto again = dilated_mask(*dilated, -reach);
        CHECK(again->activeVoxelCount() == box.volume());
        CHECK(again->evalActiveVoxelBoundingBox() == box);
    }
    CHECK(dilated_mask(*voxels_mask({{0, 0, 0}, {9, 9, 9}}), -5)->empty());
    CHECK(dilated_mask(*MaskGrid::create(), 3)->empty());
}

TEST_CASE("dilation and erosion leave the inside of large tiles alone") {
    const auto mask = MaskGrid::create();
    mask->tree().addTile(2, {0, 0, 0}, true, true);
    mask->tree().addTile(2, {128, 0, 0}, true, true);
    const auto dilated = dilated_mask(*mask, 10);
    CHECK(dilated->activeVoxelCount() == 276ull * 148 * 148);
    CHECK(dilated->tree().activeLeafVoxelCount() < dilated->activeVoxelCount() / 3);
    const auto eroded = dilated_mask(*mask, -10);
    CHECK(eroded->activeVoxelCount() == 236ull * 108 * 108);
    CHECK(eroded->tree().activeLeafVoxelCount() < eroded->activeVoxelCount() / 3);
}

TEST_CASE(
    "the mask nodes hand on what their functions give, and refuse parameters that make no sense") {
    const auto like = std::make_shared<AnyGrid>(AnyGrid{grid_of(turned())});
    const auto made = [&](NodeType type, const std::string& yaml, const NodeBench::Inputs& inputs) {
        return NodeBench(std::move(type), yaml).run(inputs).at("mask").as<MaskGrid>();
    };
    const NodeBench::Inputs place{{"like", {Payload(Ref<AnyGrid>(like))}}};
    const auto box = made(mask_box(), "{min: [0, -1, 0], max: [6, 4, 5]}", place);
    CHECK(box->tree().hasSameTopology(box_mask(*like->grid, {0, -1, 0}, {6, 4, 5})->tree()));
    const auto sphere = made(mask_sphere(), "{center: [1, 0, 2], radius: 2.5}", place);
    CHECK(sphere->tree().hasSameTopology(sphere_mask(*like->grid, {1, 0, 2}, 2.5)->tree()));
    const auto rest =
        made(mask_combine(), "mode: difference", {{"masks", {Payload(box), Payload(sphere)}}});
    CHECK(rest->tree().hasSameTopology(combined_mask({box, sphere}, MaskMode::first)->tree()));
    const auto grown = made(mask_dilate(), "voxels: -2", {{"mask", {Payload(box)}}});
    CHECK(grown->tree().hasSameTopology(dilated_mask(*box, -2)->tree()));

    CHECK(NodeBench(mask_box(), "{min: [0, 0, 2], max: [1, 1, 1]}").faults() ==
          "max: 'max' is below 'min' in z: 1 < 2\n");
    CHECK(NodeBench(mask_sphere(), "{center: [0, 0, 0], radius: -1}").faults() ==
          "radius must be at least 0, not -1\n");
    CHECK(NodeBench(mask_combine(), "mode: xor").faults() ==
          "mode must be one of union, intersection, difference, not 'xor'\n");
    CHECK(NodeBench(mask_dilate(), "voxels: 300").faults() ==
          "voxels must be from -256 to 256, not 300\n");
}
