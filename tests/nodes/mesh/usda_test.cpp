#include "formats/mesh_file/usda.h"

#include "nodes/mesh.h"
#include "tests/support/files/usda.h"
#include "tests/support/node_bench.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;
using namespace fluidcarve::test;
using Attribute = Mesh::Attribute;
using Texts = std::vector<std::string>;

namespace {

/// A quad and a triangle, with attributes of all kinds.
Mesh painted() {
    Mesh out;
    out.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0.5}, {0, 1, 0}, {2, 0, 0}};
    out.add_face(std::vector<std::uint32_t>{0, 1, 2, 3});
    out.add_face(std::vector<std::uint32_t>{1, 4, 2});
    const auto none = Attribute::none;
    out.attributes = {
        {"uv",
         Attribute::On::corners,
         {"s", "t"},
         Attribute::Type::float64,
         {0, 0, 0.25, 1},
         {0, 1, 1, 0, 1, none, 0}},
        {"colour",
         Attribute::On::vertices,
         {"red", "green", "blue", "alpha"},
         Attribute::Type::uint8,
         std::vector<double>(20, 255),
         {}},
        {"velocity",
         Attribute::On::vertices,
         {"x", "y", "z"},
         Attribute::Type::float32,
         std::vector<double>(15, 3),
         {}},
        {"material.id", Attribute::On::faces, {"material.id"}, Attribute::Type::int16, {7, -8}, {}},
        {"odd",
         Attribute::On::faces,
         {"a", "b", "c", "d", "e"},
         Attribute::Type::float32,
         std::vector<double>(10, 1),
         {}},
    };
    return out;
}

std::vector<Texts> rows(const UsdaValue& value) {
    std::vector<Texts> out;
    for (const auto& item : value.items) out.push_back(item.texts());
    return out;
}

}  // namespace

TEST_CASE("a mesh goes to USD with its faces, UVs, colours, velocities and other attributes") {
    const Scratch scratch;
    const auto losses = write_mesh_usda(scratch / "a.usda", painted(), nullptr, std::nullopt, {});
    CHECK(losses == Texts{"'odd' of faces are not written: .usda has no type for them"});
    const auto file = UsdaReader::read(Scratch::read(scratch / "a.usda"));
    CHECK(file.metadata.at("defaultPrim").text == "geometry");
    CHECK(!file.metadata.contains("startTimeCode"));
    const auto& mesh = file.prim("geometry");
    const auto& of = mesh.properties;
    CHECK(mesh.type == "Mesh");
    CHECK(of.at("uniform token subdivisionScheme").text == "none");
    CHECK(
        rows(of.at("point3f[] points")) ==
        std::vector<Texts>{
            {"0", "0", "0"}, {"1", "0", "0"}, {"1", "1", "0.5"}, {"0", "1", "0"}, {"2", "0", "0"}});
    CHECK(rows(of.at("float3[] extent")) == std::vector<Texts>{{"0", "0", "0"}, {"2", "1", "0.5"}});
    CHECK(of.at("int[] faceVertexCounts").texts() == Texts{"4", "3"});
    CHECK(of.at("int[] faceVertexIndices").texts() == Texts{"0", "1", "2", "3", "1", "4", "2"});
    const Texts a{"0", "0"}, b{"0.25", "1"};
    CHECK(rows(of.at("texCoord2f[] primvars:st")) == std::vector<Texts>{a, b, b, a, b, a, a});
    CHECK(mesh.metadata_of_properties.at("texCoord2f[] primvars:st").at("interpolation").text ==
          "faceVarying");
    CHECK(rows(of.at("color3f[] primvars:displayColor")) == std::vector<Texts>(5, {"1", "1", "1"}));
    CHECK(of.at("float[] primvars:displayOpacity").texts() == Texts(5, "1"));
    CHECK(rows(of.at("vector3f[] velocities")) == std::vector<Texts>(5, {"3", "3", "3"}));
    CHECK(of.at("int[] primvars:material_id").texts() == Texts{"7", "-8"});
    CHECK(mesh.metadata_of_properties.at("int[] primvars:material_id").at("interpolation").text ==
          "uniform");
}

TEST_CASE("mesh.write gives the meshes of a sequence the times of their frames") {
    const Scratch scratch;
    const auto mesh = std::make_shared<Mesh>(painted());
    mesh->attributes.clear();
    Context::Host silent;
    const std::vector<int> frames{-3};
    NodeBench(mesh_write(), "{path: " + scratch / "a.####.usda" + "}")
        .run({{"source", {Payload(mesh)}}}, Context(silent, frames));
    const auto file = UsdaReader::read(Scratch::read(scratch / "a.-003.usda"));
    CHECK(file.metadata.at("startTimeCode").text == "-3");
    const auto& samples =
        file.prim("geometry").properties.at("point3f[] points.timeSamples").samples;
    REQUIRE(samples.size() == 1);
    CHECK(samples[0].first == -3);
    CHECK(samples[0].second.items.size() == 5);

    // A placement that is stated is undone; that of a reader is not.
    auto origin = std::make_shared<Mesh::StoredForm>();
    origin->placement = {openvdb::Vec3d(5), 2};
    mesh->stored = origin;
    const auto last = [&](const std::string& more) {
        NodeBench(mesh_write(), "{path: " + scratch / "b.usda" + more + "}")
            .run({{"source", {Payload(mesh)}}}, Context(silent, frames));
        return UsdaReader::read(Scratch::read(scratch / "b.usda"))
            .prim("geometry")
            .properties.at("point3f[] points")
            .items.at(4)
            .texts();
    };
    CHECK(last("") == Texts{"2", "0", "0"});
    CHECK(last(", translate: [1, 0, 0], scale: 2") == Texts{"0.5", "0", "0"});
}
