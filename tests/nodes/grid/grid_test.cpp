#include "nodes/grid.h"
#include "carve/grid/crop.h"
#include "carve/grid/named_grids.h"
#include "carve/grid/prune.h"
#include "carve/grid/resample.h"
#include "formats/vdb/vdb_file.h"
#include "nodes/vdb.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/node_bench.h"
#include "tests/support/sampled.h"
#include "tests/support/scratch.h"
#include "tests/support/vdb_grid.h"

#include <openvdb/tools/GridTransformer.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <openvdb/tools/Prune.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>

using namespace fluidcarve;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;
using openvdb::Vec3s;
using test::failure_of;
using test::NodeBench;
using test::sampled;
using test::swirl;
using test::volume_of;

namespace {

constexpr std::uint64_t enough = std::uint64_t{1} << 30;
const CoordBBox cube({-9, -9, -9}, {9, 9, 9});

Volume run(NodeType type, const std::string& yaml, const Volume& volume) {
    return *NodeBench(std::move(type), yaml, {{"source", 1}})
                .run({{"source", {Payload(std::make_shared<Volume>(volume))}}})
                .at("volume")
                .as<Volume>();
}

template <class GridT>
Ref<GridT> only(const Volume& volume) {
    REQUIRE(volume.grids.size() == 1);
    return openvdb::gridConstPtrCast<GridT>(volume.grids.front());
}

openvdb::math::Transform::Ptr turned(double voxel) {
    auto out = openvdb::math::Transform::createLinearTransform(voxel);
    out->postRotate(0.4, openvdb::math::Y_AXIS);
    return out;
}

}  // namespace

TEST_CASE("grid.resample gives what OpenVDB's resampleToMatch gives, of a fog and of a level set") {
    const auto fog = sampled<FloatGrid>(cube, 0.25, swirl);
    const auto ball =
        openvdb::tools::createLevelSetSphere<FloatGrid>(3, Vec3d(0.1, 0.2, 0.3), 0.25);
    const auto transform =
        GENERATE(openvdb::math::Transform::createLinearTransform(0.1),
                 openvdb::math::Transform::createLinearTransform(0.6), turned(0.2));
    for (const auto& grid : {fog, ball}) {
        auto expected = FloatGrid::create(grid->background());
        expected->setTransform(transform->copy());
        expected->setGridClass(grid->getGridClass());
        openvdb::tools::resampleToMatch<openvdb::tools::BoxSampler>(*grid, *expected);
        const auto made = only<FloatGrid>(resampled(volume_of(grid), *transform, enough));
        CHECK(made->transform() == *transform);
        CHECK(made->getName() == grid->getName());
        CHECK(made->getGridClass() == grid->getGridClass());
        CHECK(made->activeVoxelCount() > 0);
        CHECK(test::bytes(made->tree()) == test::bytes(expected->tree()));
    }
}

TEST_CASE("grid.resample makes upright cubes of turned voxels and of a frustum") {
    const auto linear = [](const Vec3d& at) {
        return static_cast<float>(1 + at.x() - 2 * at.y() + 0.5 * at.z());
    };
    for (const auto& transform : {turned(0.25), openvdb::math::Transform::createFrustumTransform(
                                                    {Vec3d(0), Vec3d(40)}, 0.5, 8.0, 8.0)}) {
        const auto grid = FloatGrid::create();
        grid->setTransform(transform->copy());
        const CoordBBox box = transform->isLinear() ? cube : CoordBBox({0, 0, 0}, {40, 40, 40});
        for (auto at = box.begin(); at; ++at)
            grid->tree().setValue(*at, linear(grid->indexToWorld(*at)));
        const auto made =
            only<FloatGrid>(run(grid_resample(), "{voxel_size: 0.2}", volume_of(grid)));
        CHECK(made->transform() == *openvdb::math::Transform::createLinearTransform(0.2));
        std::size_t inside = 0;
        for (auto value = made->cbeginValueOn(); value; ++value) {
            const auto from = grid->worldToIndex(made->indexToWorld(value.getCoord()));
            if (!openvdb::BBoxd(box.min().asVec3d() + Vec3d(1), box.max().asVec3d() - Vec3d(1))
                     .isInside(from))
                continue;
            ++inside;
            REQUIRE(*value == Approx(linear(made->indexToWorld(value.getCoord()))).margin(0.02));
        }
        CHECK(inside > 1000);
    }
}

TEST_CASE(
    "grid.resample reads whole numbers and states from the nearest voxel, collocates faces, and "
    "leaves points") {
    const auto transform = openvdb::math::Transform::createLinearTransform(0.1);
    const auto numbers = openvdb::Int32Grid::create();
    const auto mask = MaskGrid::create();
    numbers->setTransform(openvdb::math::Transform::createLinearTransform(0.25));
    mask->setTransform(numbers->transform().copy());
    for (auto at = cube.begin(); at; ++at)
        numbers->tree().setValue(*at, (*at)[0] % 2 == 0 ? 1000 : -7);
    mask->tree().fill(CoordBBox({0, 0, 0}, {3, 3, 3}), true);
    const auto fine = only<openvdb::Int32Grid>(resampled(volume_of(numbers), *transform, enough));
    for (auto value = fine->cbeginValueOn(); value; ++value)
        REQUIRE((*value == 1000 || *value == -7));
    const auto states = only<MaskGrid>(resampled(volume_of(mask), *transform, enough));
    CHECK(states->tree().isValueOn({0, 0, 0}));
    CHECK(states->tree().isValueOn({8, 8, 8}));
    CHECK(!states->tree().isValueOn({9, 0, 0}));

    const auto faces =
        test::sampled_staggered(cube, 0.25, [](const Vec3d& at) { return Vec3s(at); });
    const auto centred = only<VectorGrid>(resampled(volume_of(faces), *transform, enough));
    CHECK(centred->getGridClass() == openvdb::GRID_UNKNOWN);
    CHECK((centred->tree().getValue({7, -3, 12}) - Vec3s(0.7f, -0.3f, 1.2f)).length() < 1e-5f);
}

TEST_CASE(
    "grid.resample refuses voxels that would not fit in memory, and needs to be told their size "
    "once") {
    const auto fog = sampled<FloatGrid>(cube, 0.25, swirl);
    CHECK(failure_of([&] {
              resampled(volume_of(fog), *openvdb::math::Transform::createLinearTransform(0.0025),
                        1 << 30);
          }) ==
          "grid 'sampled' would have 6.86e+09 voxels, which take 27.4 GB, but --memory allows 1.07 "
          "GB: take larger voxels");
    CHECK(NodeBench(grid_resample(), "{}").faults() ==
          "type: needs 'voxel_size', or a grid 'like' whose voxels it takes\n");
    CHECK(NodeBench(grid_resample(), "{voxel_size: 1}", {{"like", 1}}).faults() ==
          "voxel_size: 'like' already states the voxels; leave 'like' or 'voxel_size' out\n");
}

TEST_CASE("a resampled grid is written in its file's space, on its new voxels") {
    const Scratch scratch;
    write_vdb(scratch / "a.vdb", volume_of(sampled<FloatGrid>(cube, 0.25, swirl)));
    const auto read =
        NodeBench(vdb_read(), "{path: " + (scratch / "a.vdb") + ", scale: 2, translate: [1, 2, 3]}")
            .run({})
            .at("volume");
    const auto made =
        std::make_shared<Volume>(run(grid_resample(), "{voxel_size: 0.25}", *read.as<Volume>()));
    NodeBench(vdb_write(), "{path: " + (scratch / "b.vdb") + "}", {{"source", 1}})
        .run({{"source", {Payload(made)}}});
    const auto written = read_vdb_grid(scratch / "b.vdb", "sampled");
    CHECK(written->transform().voxelSize().x() == Approx(0.125));
    CHECK((written->transform().indexToWorld(Vec3d(0)) - Vec3d(-0.5, -1, -1.5)).length() < 1e-12);
}

TEST_CASE("grid.crop leaves what lies in the box, of every type of grid") {
    auto volume = volume_of(sampled<FloatGrid>(cube, 0.25, swirl));
    const auto mask = MaskGrid::create();
    mask->setTransform(openvdb::math::Transform::createLinearTransform(0.25));
    mask->tree().fill(cube, true);
    volume.grids.push_back(mask);
    const auto made = run(grid_crop(), "{min: [-1, -0.5, -10], max: [0.25, 0.5, 0]}", volume);
    for (const auto& grid : made.grids)
        CHECK(grid->evalActiveVoxelBoundingBox() == CoordBBox({-4, -2, -9}, {1, 2, 0}));
    CHECK(volume.grids.front()->evalActiveVoxelBoundingBox() == cube);
    CHECK(NodeBench(grid_crop(), "{min: [0, 0, 1], max: [1, 1, 0]}").faults() ==
          "max: 'max' is below 'min' in z: 0 < 1\n");
}

TEST_CASE("grid.prune joins voxels as OpenVDB's prune does, and takes out what is below") {
    const auto fog = sampled<FloatGrid>(CoordBBox({0, 0, 0}, {31, 31, 31}), 1, [](const Vec3d& at) {
        return at.x() < 16 ? 0.5f + 1e-4f * float(at.y()) : 0.01f;
    });
    const auto expected = fog->deepCopy();
    openvdb::tools::prune(expected->tree(), 0.01f);
    const auto made = only<FloatGrid>(run(grid_prune(), "{tolerance: 0.01}", volume_of(fog)));
    CHECK(made->tree().leafCount() == 0);
    CHECK(test::bytes(made->tree()) == test::bytes(expected->tree()));
    const auto thin = only<FloatGrid>(run(grid_prune(), "{below: 0.02}", volume_of(fog)));
    CHECK(thin->evalActiveVoxelBoundingBox() == CoordBBox({0, 0, 0}, {15, 31, 31}));
    CHECK(thin->tree().getValue({20, 0, 0}) == 0);
    CHECK(thin->tree().getValue({15, 3, 0}) == fog->tree().getValue({15, 3, 0}));
    const auto ball = openvdb::tools::createLevelSetSphere<FloatGrid>(3, Vec3d(0), 0.25);
    CHECK(test::bytes(only<FloatGrid>(run(grid_prune(), "{below: 10}", volume_of(ball)))->tree()) ==
          test::bytes(ball->tree()));
}

TEST_CASE(
    "grid.pick keeps or drops grids by names and patterns, and names what no grid is called") {
    Volume volume;
    for (const auto* const name : {"density", "vel.x", "vel.y", "heat"}) {
        const auto grid = FloatGrid::create();
        grid->setName(name);
        volume.grids.push_back(grid);
    }
    CHECK(run(grid_pick(), "{keep: [heat, vel*]}", volume).names() == "vel.x, vel.y, heat");
    CHECK(run(grid_pick(), "{drop: ['*.?']}", volume).names() == "density, heat");
    CHECK(failure_of([&] { picked(volume, {"densty"}, true); }) ==
          "the volume has no grid 'densty'; it has density, vel.x, vel.y, heat; did you mean "
          "'density'?");
    CHECK(NodeBench(grid_pick(), "{}").faults() == "type: needs either 'keep' or 'drop'\n");
    CHECK(NodeBench(grid_pick(), "{keep: [a], drop: [b]}").faults() ==
          "type: needs either 'keep' or 'drop'\n");
}

TEST_CASE(
    "several grids of one name are found by their place, a name without a place is the first") {
    Volume volume;
    for (const auto* const name : {"density", "heat", "density", "", "a[1]"}) {
        const auto grid = FloatGrid::create();
        grid->setName(name);
        volume.grids.push_back(grid);
    }
    CHECK(volume.unique_names() ==
          std::vector<std::string>{"density[0]", "heat", "density[1]", "", "a[1]"});
    const auto place = [&](const std::string& name) { return *volume.place(name); };
    CHECK(place("density") == 0);
    CHECK(place("density[0]") == 0);
    CHECK(place("density[1]") == 2);
    CHECK(place("heat[0]") == 1);
    CHECK(place("[0]") == 3);
    CHECK(place("a[1]") == 4);
    for (const auto* const none :
         {"density[2]", "density[]", "density[-1]", "density[1]]", "smoke", "[1]"})
        CHECK(volume.find(none) == nullptr);
}

TEST_CASE("vdb.write stores the grids that it is told in half floats, or in whole ones") {
    const Scratch scratch;
    auto fog = sampled<FloatGrid>(CoordBBox({0, 0, 0}, {63, 63, 63}), 1, swirl),
         heat = fog->deepCopy();
    heat->setName("heat");
    Volume volume;
    volume.grids = {fog, heat};
    const auto write = [&](const std::string& name, const Volume& from, const std::string& more) {
        NodeBench(vdb_write(), "{path: " + (scratch / name) + ", compression: none" + more + "}",
                  {{"source", 1}})
            .run({{"source", {Payload(std::make_shared<Volume>(from))}}});
        return std::filesystem::file_size(scratch / name);
    };
    const auto whole = write("a.vdb", volume, "");
    const auto half = write("b.vdb", volume, ", half: [heat]");
    CHECK(half < 0.8 * static_cast<double>(whole));
    const auto read = read_vdb(scratch / "b.vdb");
    CHECK(!read.grids[0]->saveFloatAsHalf());
    CHECK(read.grids[1]->saveFloatAsHalf());
    CHECK(!heat->saveFloatAsHalf());
    CHECK(write("c.vdb", read, ", full: ['*']") == Approx(whole).epsilon(0.01));
    CHECK(failure_of([&] { write("d.vdb", volume, ", half: [smoke]"); }) ==
          "the volume has no grid 'smoke'; it has sampled, heat");
}
