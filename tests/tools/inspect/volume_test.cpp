#include "tools/inspect/volume.h"

#include "formats/vdb/vdb_file.h"
#include "tests/support/node_bench.h"
#include "tests/support/scratch.h"

#include <fmt/format.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <catch2/catch.hpp>

#include <limits>

using namespace fluidcarve;
using Json = nlohmann::ordered_json;

namespace {

const std::string data = TEST_DATA;

std::vector<std::string> oddities(const Json& facts) {
    return facts["oddities"].get<std::vector<std::string>>();
}

openvdb::GridBase::Ptr named(const openvdb::GridBase::Ptr& grid, const std::string& name) {
    grid->setName(name);
    return grid;
}

/// What is said of a file whose version is not the library's own.
std::string version_note(unsigned version) {
    return fmt::format("the file's version is {}; it would be written as {}", version,
                       static_cast<unsigned>(openvdb::OPENVDB_FILE_VERSION));
}

Json look_at(const Scratch& scratch, const Volume& volume) {
    write_vdb(scratch / "a.vdb", volume);
    return vdb_inspector().look(scratch / "a.vdb");
}

}  // namespace

TEST_CASE("inspect says what is in a file of Blender's, and what surprises in it") {
    const auto facts = vdb_inspector().look(data + "/plume/plume.0056.vdb");
    CHECK(facts["profile"] == "blender");
    CHECK(facts["compression"] == "blosc");
    REQUIRE(facts["grids"].size() == 5);
    const auto& density = facts["grids"][1];
    CHECK(density["name"] == "density");
    CHECK(density["type"] == "float");
    CHECK(density["class"] == "fog volume");
    CHECK(density["half"] == true);
    CHECK(density["active_voxels"] == 84824);
    CHECK(density["box"] == Json{{1, 1, 1}, {42, 42, 86}});
    const double voxel = density["transform"]["voxel_size"][0];
    for (int axis = 0; axis < 3; ++axis) {
        CHECK(density["world_box"][0][axis].get<double>() == Approx(0.5 * voxel));
        CHECK(density["world_box"][1][axis].get<double>() ==
              Approx((axis == 2 ? 86.5 : 42.5) * voxel));
    }
    CHECK(density["range"][1].get<double>() == Approx(0.996582).epsilon(1e-6));
    CHECK(density["metadata"]["file_base_resolution"] == "[44, 44, 88]");
    auto odd = oddities(facts);
    // Libraries write 224 up to OpenVDB 12.
    std::erase(odd, version_note(224));
    CHECK(odd ==
          std::vector<std::string>{
              "velocity: staggered: component c stands on the face below its voxel along axis c",
              "velocity: its vector type is invariant: other tools don't rotate it with its "
              "transform",
              "velocity: if Blender wrote it, in tenths of a voxel per frame, roughly",
              "density, temperature: active only above 1e-06: derivatives jump at the border of "
              "the smoke",
              "shadow: -1 everywhere in its box: it shows no content, so fit the lattice to "
              "another grid",
              "flame: no active voxels",
              "the grids start at the world's origin: Blender's caches lose their place in the "
              "scene; the reader's `translate` gives it back",
          });
}

TEST_CASE("inspect's text names file, grids, spaces and notes") {
    CHECK(vdb_inspector().text(vdb_inspector().look(data + "/vdb/gaffer_arnold_sphere.vdb")) ==
          data +
              "/vdb/gaffer_arnold_sphere.vdb: 78110 bytes, version 223, compression blosc, as "
              "Houdini writes\n"
              "  creator: Houdini 15.0.244.16/GEO_VDBTranslator\n"
              "  density  float    fog volume             465 voxels in [-5,-4,-5] to [5,4,5], "
              "world [-1.1, 1.1, -1.1] to [1.1, 2.9, 1.1], 1.11658e-07 to 1\n"
              "  voxels of [0.2, 0.2, 0.2], the first at [0, 2, 0], UniformScaleTranslateMap "
              "(density)\n"
              "  note: " +
              version_note(223) + "\n");
    CHECK_THAT(vdb_inspector().text(vdb_inspector().look(data + "/vdb/cortex_points.vdb")),
               Catch::Contains(", 8 points with P (vec3s fxpt16)\n"));
}

TEST_CASE(
    "inspect finds values that are not finite, odd voxels, odd level sets, shared and equal-named "
    "grids") {
    openvdb::initialize();
    const Scratch scratch;
    const auto bad = FloatGrid::create();
    bad->tree().setValue({3, 4, 5}, std::numeric_limits<float>::quiet_NaN());
    bad->tree().setValue({2, 4, 5}, std::numeric_limits<float>::infinity());
    bad->tree().setValue({1, 4, 5}, 2.5f);
    const auto flat = FloatGrid::create();
    flat->tree().setValue({0, 0, 0}, 1);
    flat->setTransform(openvdb::math::Transform::createLinearTransform(
        openvdb::math::Mat4d(.1, 0., 0., 0., 0., .2, 0., 0., 0., 0., .1, 0., 0., 0., 0., 1.)));
    const auto dense = FloatGrid::create(0);
    dense->tree().setValue({0, 0, 0}, 1);
    dense->setGridClass(openvdb::GRID_LEVEL_SET);
    const auto facts =
        look_at(scratch,
                {{named(bad, "density"), named(flat, "flat"), named(dense, "phi"), bad->copyGrid()},
                 {},
                 {}});
    CHECK(facts["profile"].is_null());
    CHECK(facts["grids"][0]["range"] == Json{2.5, 2.5});
    CHECK(oddities(facts) ==
          std::vector<std::string>{
              "density[0], density[1]: 2 values are not finite, the first at voxel [2,4,5]: "
              "energies refuse them",
              "density[0], density[1]: no class: treated as a fog volume",
              "flat: voxels that are no cubes (0.1 x 0.2 x 0.1): distances refuse them",
              "phi: called a level set, but its background is not above 0: dense values in voxels, "
              "no narrow band",
              "flat: another transform than density[0]",
              "density[1]: not the only grid of its name",
              "density[1]: shares its voxels with a grid before it",
          });
    CHECK(oddities(look_at(scratch, {})) == std::vector<std::string>{"no grids"});
}

TEST_CASE("inspect tells three grids that are one vector") {
    const Scratch scratch;
    Volume volume;
    for (const auto* name : {"vel.x", "vel.y", "vel.z"}) {
        const auto grid = FloatGrid::create();
        grid->tree().setValue({0, 0, 0}, 1);
        volume.grids.push_back(named(grid, name));
    }
    CHECK(
        oddities(look_at(scratch, volume)) ==
        std::vector<std::string>{
            "vel.x, vel.y, vel.z: a vector in three grids: name it under `grids: {vel: vector}`"});
}

TEST_CASE("several files are compared: grids whose voxels or domain change are told once") {
    const auto at = [](const std::string& file, double size, const std::string& domain) {
        return Json{{"file", file},
                    {"grids",
                     {{{"name", "density"},
                       {"transform", {{"voxel_size", {size, size, size}}, {"origin", {0, 0, 0}}}},
                       {"metadata", {{"file_base_resolution", domain}}}},
                      {{"name", "heat"},
                       {"transform", {{"voxel_size", {size, size, size}}, {"origin", {0, 0, 0}}}},
                       {"metadata", {{"file_base_resolution", domain}}}}}}};
    };
    const auto compare = vdb_inspector().compare;
    CHECK(compare({at("a", 0.1, "[8, 8, 8]"), at("b", 0.1, "[8, 8, 8]")}).empty());
    CHECK(compare(
              {at("a", 0.1, "[8, 8, 8]"), at("b", 0.1, "[8, 8, 9]"), at("c", 0.2, "[8, 8, 9]")}) ==
          std::vector<std::string>{
              "density, heat: voxels of 0.1, 0.1, 0.1 in a domain of [8, 8, 8] in a, but voxels of "
              "0.1, 0.1, 0.1 in a domain of [8, 8, 9] in b: if "
              "these are frames of one sequence, its domain is adaptive, and no lattice fits"});
}

TEST_CASE("of very many entries of metadata the first are listed, and their number is told") {
    const Scratch scratch;
    Volume volume;
    const auto grid = named(FloatGrid::create(), "density");
    for (int n = 0; n < 1234; ++n) {
        grid->insertMeta("entry" + std::to_string(n), openvdb::StringMetadata("text"));
        volume.metadata.insertMeta("entry" + std::to_string(n), openvdb::StringMetadata("text"));
    }
    volume.grids = {grid};
    const auto facts = look_at(scratch, volume);
    CHECK(facts["metadata"].size() == 1000);
    CHECK(facts["grids"][0]["metadata"].size() == 1000);
    const auto lines = oddities(facts);
    const auto tells = [&](const std::string& start) {
        return std::ranges::any_of(lines, [&](const auto& line) {
            return line.starts_with(start) &&
                   line.ends_with("entries of metadata, of which the first 1000 are listed");
        });
    };
    CHECK(tells("1234"));
    CHECK(tells("density: 12"));
}
