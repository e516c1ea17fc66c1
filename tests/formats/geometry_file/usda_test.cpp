#include "formats/geometry_file/usda.h"

#include "tests/support/files/usda.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

#include <limits>

using namespace fluidcarve;

TEST_CASE("any name becomes one that USD takes, and no two become the same") {
    UsdNames names;
    CHECK(names.add("density") == "density");
    CHECK(names.add("vel.x") == "vel_x");
    CHECK(names.add("vel_x") == "vel_x_2");
    CHECK(names.add("vel-x") == "vel_x_3");
    CHECK(names.add("2d") == "_2d");
    CHECK(names.add("") == "_");
    CHECK(names.add("r\xc3\xb6te") == "r__te");
    CHECK(is_usd_name("_a1"));
    for (const auto* const bad : {"", "1a", "a b", "a.b", "a:b", "\xc3\xb6"})
        CHECK(!is_usd_name(bad));
}

TEST_CASE("texts and files of USD are quoted, whatever is in them") {
    CHECK(usd_text("a \"b\" \\c\n") == "\"a \\\"b\\\" \\\\c\\x0a\"");
    CHECK(usd_asset("./a b.vdb") == "@./a b.vdb@");
    CHECK(usd_asset("./a@b.vdb") == "@@@./a@b.vdb@@@");
    CHECK(usd_asset("./a@@@b.vdb") == "@@@./a\\@@@b.vdb@@@");
}

TEST_CASE("a file of geometry holds its arrays at all times, or at those of one frame") {
    UsdGeometry still("Mesh", std::nullopt);
    still.add("uniform token subdivisionScheme = \"none\"");
    still.add_positions({openvdb::Vec3d(0), openvdb::Vec3d(1, static_cast<double>(0.1f), -2)},
                        nullptr);
    still.add({"texCoord2f", "primvars:st", "faceVarying", 2}, {0, 0.5});
    CHECK(still.text() == R"(#usda 1.0
(
    defaultPrim = "geometry"
)

def Mesh "geometry"
{
    uniform token subdivisionScheme = "none"
    point3f[] points = [(0, 0, 0), (1, 0.1, -2)]
    float3[] extent = [(0, 0, -2), (1, 0.1, 0)]
    texCoord2f[] primvars:st = [(0, 0.5)] (
        interpolation = "faceVarying"
    )
}
)");

    constexpr auto infinite = std::numeric_limits<double>::infinity(),
                   nan = std::numeric_limits<double>::quiet_NaN();
    UsdGeometry moving("Points", -5);
    moving.add({"float", "widths", "vertex"}, {static_cast<double>(0.1f), -nan, -infinite});
    moving.add_positions({}, nullptr);
    CHECK(moving.text() == R"(#usda 1.0
(
    defaultPrim = "geometry"
    endTimeCode = -5
    startTimeCode = -5
)

def Points "geometry"
{
    float[] widths (
        interpolation = "vertex"
    )
    float[] widths.timeSamples = {
        -5: [0.1, nan, -inf],
    }
    point3f[] points.timeSamples = {
        -5: [],
    }
}
)");
    CHECK(test::UsdaReader::read(moving.text())
              .prim("geometry")
              .properties.at("float[] widths.timeSamples")
              .samples.at(0)
              .first == -5);
}

TEST_CASE("a primvar has the type of its numbers, and all their digits") {
    UsdGeometry out("Points", std::nullopt);
    CHECK(out.add_primvar("age", "vertex", 1, NumberType::float64, {0.1}));
    CHECK(out.add_primvar("age", "vertex", 3, NumberType::float32,
                          {1, 2, static_cast<double>(0.3f)}));
    CHECK(out.add_primvar("key", "vertex", 1, NumberType::uint32, {4294967295.0}));
    CHECK(out.add_primvar("kind", "uniform", 2, NumberType::int8, {-1, 1}));
    out.add({"color3f", "primvars:displayColor", "vertex", 3}, {1, 1, 1});
    CHECK(out.has("primvars:displayColor"));
    CHECK(out.add_primvar("displayColor", "vertex", 1, NumberType::float32, {1}));
    CHECK(!out.add_primvar("many", "vertex", 5, NumberType::float32, {1, 2, 3, 4, 5}));
    CHECK(!out.add_primvar("keys", "vertex", 2, NumberType::uint32, {1, 2}));
    const auto prim = test::UsdaReader::read(out.text()).prim("geometry");
    CHECK(prim.properties.size() == 6);
    CHECK(prim.properties.at("double[] primvars:age").texts() == std::vector<std::string>{"0.1"});
    CHECK(prim.properties.at("float3[] primvars:age_2").items.at(0).texts() ==
          std::vector<std::string>{"1", "2", "0.3"});
    CHECK(prim.properties.at("uint[] primvars:key").texts() ==
          std::vector<std::string>{"4294967295"});
    CHECK(prim.properties.at("int2[] primvars:kind").items.at(0).texts() ==
          std::vector<std::string>{"-1", "1"});
    CHECK(prim.properties.contains("float[] primvars:displayColor_2"));
    CHECK(prim.metadata_of_properties.at("int2[] primvars:kind").at("interpolation").text ==
          "uniform");
}
