#include "nodes/python/grid_script.h"

#include "carve/field/collocate.h"
#include "graph/types/context.h"
#include "nodes/python/python_value.h"
#include "nodes/python/shared_memory.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/node_bench.h"
#include "tests/support/scratch.h"

#include <openvdb/tools/LevelSetSphere.h>
#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <vector>

using namespace fluidcarve;
using openvdb::Coord;
using test::failure_of;

namespace {

using Inputs = GridScript::Inputs;

Ref<AnyGrid> any(const openvdb::GridBase::ConstPtr& grid) {
    return std::make_shared<AnyGrid>(AnyGrid{grid});
}

/// A script with one function, called once.
struct Called {
    Scratch scratch;
    GridScriptParams params;
    explicit Called(const std::string& function) {
        params.script = InputPath(scratch.write("script.py", "import numpy as np\n\n" + function));
        params.python = "/usr/bin/python3";
        params.timeout = 60;
    }
    FloatGrid::Ptr field(const Inputs& inputs, Context context = {}) const {
        return GridScript().numbers(params, "field", -std::numeric_limits<float>::infinity(),
                                    inputs, context);
    }
    MaskGrid::Ptr mask(const Inputs& inputs, Context context = {}) const {
        return GridScript().states(params, "mask", inputs, context);
    }
};

/// Values that differ from voxel to voxel, in leaves that are full, half full and far apart.
FloatGrid::Ptr some_field() {
    const auto out = FloatGrid::create(0.25f);
    for (int x = -11; x < 70; ++x)
        for (int y = 3; y < 14; ++y)
            for (int z = -9; z < 20; ++z)
                if ((x + y * z) % 5 != 0)
                    out->tree().setValue({x, y, z},
                                         static_cast<float>(std::sin(x + 3 * y - 2 * z)));
    out->tree().setValue({300, 0, 0}, 2);
    out->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
    return out;
}

}  // namespace

TEST_CASE("a script gets values and voxels bit for bit, and hands them back so") {
    const auto field = some_field();
    const Inputs inputs{{"d", any(field)}};
    for (const std::string what : {"d.leaves", "d.values", "d.dense()", "d", "d.like(d.values)"}) {
        INFO(what);
        const auto out = Called("def field(d): return " + what).field(inputs);
        CHECK(out->transform() == field->transform());
        CHECK(out->getName() == "field");
        CHECK(out->tree().hasSameTopology(field->tree()));
        for (auto voxel = field->cbeginValueOn(); voxel; ++voxel)
            REQUIRE(out->tree().getValue(voxel.getCoord()) == *voxel);
        CHECK(out->background() == 0);
    }
}

TEST_CASE("active tiles become voxels, and inactive ones keep their value in dense()") {
    const auto sphere =
        openvdb::tools::createLevelSetSphere<FloatGrid>(12, openvdb::Vec3f(0), 0.5f);
    // Inside the band, tiles are inactive and negative.
    const auto inside =
        Called("def field(d):\n    i, j, k = -np.asarray(d.box[0])\n    return d.dense()[i, j, k]")
            .field({{"d", any(sphere)}});
    CHECK(*inside->cbeginValueOn() == -sphere->background());

    const auto block = FloatGrid::create();
    block->tree().addTile(1, Coord(8), 3, true);
    REQUIRE(block->activeVoxelCount() == 512);
    REQUIRE(block->tree().leafCount() == 0);
    const auto twice =
        Called("def field(d):\n    assert d.leaves.shape == (1, 8, 8, 8)\n    return 2 * d.values")
            .field({{"d", any(block)}});
    CHECK(twice->activeVoxelCount() == 512);
    CHECK(twice->tree().getValue(Coord(9, 10, 11)) == 6);
}

TEST_CASE(
    "grids that differ in voxels are handed over with all voxels of both, and masks as true and "
    "false") {
    const auto a = FloatGrid::create(), b = FloatGrid::create(7.0f);
    a->tree().setValue({0, 0, 0}, 1);
    b->tree().setValue({20, 0, 0}, 2);
    const auto m = MaskGrid::create();
    m->tree().setValueOn({0, 0, 0});
    const auto out = Called("def field(a, b, m): return a.values + 10 * b.values + 100 * m.values")
                         .field({{"a", any(a)}, {"b", any(b)}, {"m", any(m)}});
    CHECK(out->activeVoxelCount() == 2);
    CHECK(out->tree().getValue({0, 0, 0}) == 171);
    CHECK(out->tree().getValue({20, 0, 0}) == 20);
}

TEST_CASE("a staggered velocity is collocated before a script gets it") {
    const auto faces = VectorGrid::create();
    for (int x = 0; x < 4; ++x)
        faces->tree().setValue({x, 0, 0}, openvdb::Vec3s(static_cast<float>(x), 1, 2));
    faces->setGridClass(openvdb::GRID_STAGGERED);
    const auto centres = collocated(faces);
    const auto out = Called("def field(v): return v.dense()[..., 0]").field({{"v", any(faces)}});
    for (auto voxel = centres->cbeginValueOn(); voxel; ++voxel)
        CHECK(out->tree().getValue(voxel.getCoord()) == (*voxel)[0]);
}

TEST_CASE("a mask has the voxels for which a script says so, also beside those of its inputs") {
    const auto field = some_field();
    const auto out = Called("def mask(d): return d.dense() > 0.5").mask({{"d", any(field)}});
    for (auto voxel = field->cbeginValueOn(); voxel; ++voxel)
        CHECK(out->tree().isValueOn(voxel.getCoord()) == (*voxel > 0.5f));
    const auto all =
        Called("def mask(d): return np.ones_like(d.dense(), bool)").mask({{"d", any(field)}});
    CHECK(all->activeVoxelCount() == static_cast<openvdb::Index64>(312) * 14 * 29);
}

TEST_CASE("blocks with a halo give the same bytes as the whole frame, and the same mask") {
    const auto field = some_field();
    Called script(
        "def field(d): return np.gradient(d.dense())[0]\n\ndef mask(d): return "
        "np.gradient(d.dense())[2] > 0.1");
    const Inputs inputs{{"d", any(field)}};
    const auto a = script.field(inputs);
    const auto in_whole = script.mask(inputs);
    script.params.halo = 1;
    const auto b = script.field(inputs);
    const auto in_blocks = script.mask(inputs);
    CHECK(a->tree().hasSameTopology(b->tree()));
    for (auto voxel = a->cbeginValueOn(); voxel; ++voxel)
        REQUIRE(b->tree().getValue(voxel.getCoord()) == *voxel);
    // Far from all voxels there is no block.
    in_whole->topologyIntersection(*field);
    in_blocks->topologyIntersection(*field);
    CHECK(in_blocks->tree().hasSameTopology(in_whole->tree()));
    CHECK(in_whole->activeVoxelCount() > 100);
}

TEST_CASE("what scripts can't take is refused before any is called") {
    const auto whole = openvdb::Int32Grid::create();
    const auto field = some_field(), other = FloatGrid::create();
    const Called script("def field(d, e): return 1 / 0");
    CHECK(failure_of([&] {
              script.field({{"d", any(whole)}});
          }) ==
          "input 'd' is the grid '' of type int32; scripts take numbers (float), vectors (vec3s) "
          "and masks");
    CHECK(failure_of([&] {
              script.field({{"d", any(field)}, {"e", any(other)}});
          }).starts_with("inputs 'd' and 'e' "));
    const auto huge = FloatGrid::create();
    huge->tree().addTile(3, Coord(0), 1, true);
    CHECK(failure_of([&] {
              script.field({{"d", any(huge)}}, Context().limits({1 << 20, "."}));
          }).find("--memory allows") != std::string::npos);
}

TEST_CASE("an empty grid is handed over, too") {
    const auto out = Called(
                         "def field(d):\n    assert d.values.shape == (0,) and d.dense().shape == "
                         "(0, 0, 0)\n    return d.values")
                         .field({{"d", any(FloatGrid::create())}});
    CHECK(out->empty());
}

TEST_CASE("values for scripts keep their kind through YAML") {
    const auto value = [](const std::vector<std::string>& items, bool list = true) {
        return PythonValue{list, items};
    };
    CHECK(value({"3"}, false).json().dump() == "3");
    CHECK(value({"2.5"}, false).json().dump() == "2.5");
    CHECK(value({"true"}, false).json().dump() == "true");
    CHECK(value({"a b"}, false).json().dump() == "\"a b\"");
    CHECK(value({"1", "x", "-2e3"}).json().dump() == "[1,\"x\",-2000.0]");
    CHECK(ParamTraits<PythonValue>::text(value({"a: b", "c"})) == "[\"a: b\", c]");
}

TEST_CASE("shared memory grows, and what is not there is not read") {
    SharedMemory memory;
    auto* const data = memory.grown(10);
    data[9] = std::byte{7};
    CHECK(memory.grown(std::uint64_t{9} << 20)[9] == std::byte{7});
    CHECK(memory.seen(std::uint64_t{9} << 20)[9] == std::byte{7});
    CHECK(failure_of([&] { memory.seen(std::uint64_t{1} << 40); }) ==
          "the worker handed over less than it said");
}
