#include "tools/draft/contents.h"

#include <catch2/catch.hpp>

#include <array>

using namespace fluidcarve;

namespace {

using Json = nlohmann::ordered_json;
using Matter = Contents::Matter;

/// A grid as the inspector of volumes describes it.
/// @param high  highest value, above a lowest of 0; 0: no active voxels
Json grid(const std::string& name, const std::string& type, const std::string& kind, double high,
          double voxel = 0.5) {
    Json out{{"name", name},
             {"type", type},
             {"class", kind},
             {"active_voxels", high > 0 ? 8 : 0},
             {"transform", {{"voxel_size", {voxel, voxel, voxel}}}}};
    if (high > 0) {
        out["range"] = {0, high};
        out["world_box"] = {{0, 0, 0}, {1, 2, 4}};
    }
    return out;
}
Json fog(const std::string& name, double high) { return grid(name, "float", "fog volume", high); }
Json particles(const Json& attributes) {
    auto out = grid("drops", "ptdataidx32", "unknown", 1);
    out["points"] = {{"count", 8}, {"attributes", attributes}};
    return out;
}

Json volume(const std::vector<Json>& grids, const std::string& profile = "blender") {
    return {{"file", "a.vdb"}, {"kind", "volume"}, {"profile", profile}, {"grids", grids}};
}

}  // namespace

TEST_CASE("smoke, fire, liquids and particles are known by the grids that have content") {
    const auto smoke =
        contents_of({volume({fog("shadow", 1), fog("flame", 0), fog("density", 1)})});
    CHECK(smoke.matter == Matter::smoke);
    CHECK(smoke.main == "density");
    CHECK(smoke.profile == "blender");
    CHECK(smoke.voxel == 0.5);
    CHECK(smoke.box == openvdb::BBoxd(openvdb::Vec3d(0), openvdb::Vec3d(1, 2, 4)));

    // One frame with flames is enough.
    const auto fire = contents_of({volume({fog("flame", 0), fog("density", 1)}),
                                   volume({fog("flame", 1), fog("density", 1)})});
    CHECK(fire.matter == Matter::fire);
    CHECK(fire.main == "density");
    CHECK(fire.flame == "flame");

    const auto liquid = contents_of(
        {volume({grid("vel", "vec3s", "staggered", 3), grid("surface", "float", "level set", 1)})});
    CHECK(liquid.matter == Matter::level_set);
    CHECK(liquid.main == "surface");
    CHECK(liquid.velocity == "vel");
    CHECK(contents_of({volume({grid("vel", "vec3s", "staggered", 3, 1),
                               grid("surface", "float", "level set", 1)})})
              .velocity.empty());

    const auto drops = contents_of(
        {volume({grid("velocity", "vec3s", "staggered", 3), particles({{"id", "int32 null"}})})});
    CHECK(drops.matter == Matter::particles);
    CHECK(drops.main == "drops");
    CHECK(drops.velocity == "velocity");
    CHECK_FALSE(drops.alone);
    CHECK(drops.identified);
    CHECK(contents_of({volume({particles(Json::object())})}).alone);
}

TEST_CASE("grids with one value everywhere, or not in every file, are no content") {
    auto constant = fog("density", 1);
    constant["range"] = {0, 0};
    const auto other = contents_of(
        {volume({constant, fog("heat", 2)}), volume({constant, fog("heat", 2), fog("smoke", 1)})});
    CHECK(other.matter == Matter::smoke);
    CHECK(other.main == "heat");
    CHECK_THROWS_WITH(contents_of({volume({constant})}),
                      Catch::StartsWith("a.vdb holds nothing that can be carved"));
    CHECK(contents_of({volume({grid("Cd", "vec3s", "unknown", 1)})}).vectors);
}

TEST_CASE("a frame that lacks the grid that says what the files are is named, with the grid") {
    auto first = volume({fog("density", 1)}), second = volume({fog("heat", 1)}), empty = volume({});
    first["file"] = "a.0001.vdb";
    second["file"] = "a.0003.vdb";
    empty["file"] = "a.0004.vdb";
    CHECK_THROWS_WITH(contents_of({first, second, first}),
                      "a.0003.vdb has no grid 'density', which a.0001.vdb has; it has heat");
    CHECK_THROWS_WITH(contents_of({first, empty}),
                      "a.0004.vdb has no grid 'density', which a.0001.vdb has; it has none");
    // Another grid that both have does not take its place.
    CHECK_THROWS_WITH(contents_of({volume({fog("density", 1), fog("heat", 1)}), second}),
                      "a.0003.vdb has no grid 'density', which a.vdb has; it has heat");
}

TEST_CASE(
    "of several grids of one name the first is looked at, and those with content move alike") {
    const auto found = contents_of({volume(
        {fog("density[0]", 1), fog("density[1]", 0), fog("density[2]", 1), fog("heat", 1)})});
    CHECK(found.main == "density[0]");
    CHECK(found.same == std::vector<std::string>{"density[2]"});
    CHECK(contents_of({volume({fog("density", 1), fog("heat", 1)})}).same.empty());
}

TEST_CASE(
    "what stays in place is the end that stands still while the other moves, and upwards the end "
    "on which things stand") {
    const auto sources = [](const std::vector<std::array<double, 6>>& boxes,
                            const std::string& profile = "blender") {
        std::vector<Json> files;
        for (const auto& box : boxes) {
            auto density = fog("density", 1);
            density["world_box"] = {{box[0], box[1], box[2]}, {box[3], box[4], box[5]}};
            files.push_back(volume({density}, profile));
        }
        return contents_of(files).source;
    };
    using Sources = std::array<std::string, 3>;
    CHECK(sources({{0, 0, 0, 4, 4, 4}}) == Sources{"middle", "middle", "low"});
    CHECK(sources({{0, 0, 0, 4, 4, 4}}, "houdini") == Sources{"middle", "low", "middle"});
    CHECK(sources({{0, 0, 0, 4, 4, 4}, {0, -2, 0.5, 8, 4, 9}}) == Sources{"low", "high", "low"});
    CHECK(sources({{0, 0, 2, 4, 4, 4}, {-2, 0, 0, 8, 4, 9}}) ==
          Sources{"middle", "middle", "middle"});
}

TEST_CASE("images are looked at by their green, and meshes become volumes of a hundred voxels") {
    const auto picture = contents_of(
        {{{"file", "a.png"}, {"kind", "image"}, {"channels", {{{"name", "R"}}, {{"name", "G"}}}}}});
    CHECK(picture.matter == Matter::image);
    CHECK(picture.main == "G");
    const Json mesh{{"file", "a.obj"},
                    {"kind", "mesh"},
                    {"faces", 6},
                    {"world_box", {{0, 0, 0}, {9.6, 1, 1}}},
                    {"attributes", Json::array()}};
    CHECK(contents_of({mesh}).voxel == Approx(0.1));
    CHECK_THROWS_WITH(contents_of({{{"file", "a.csv"}, {"kind", "curve"}}}),
                      Catch::StartsWith("a.csv is a curve"));
}
