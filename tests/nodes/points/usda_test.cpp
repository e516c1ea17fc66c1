#include "formats/points_file/usda.h"

#include "nodes/points.h"
#include "tests/support/files/point_files.h"
#include "tests/support/files/usda.h"
#include "tests/support/node_bench.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;
using namespace fluidcarve::test;
using Texts = std::vector<std::string>;

namespace {

UsdaPrim prim_of(const std::string& path) {
    return UsdaReader::read(Scratch::read(path)).prim("geometry");
}

}  // namespace

TEST_CASE("points go to USD with velocities and primvars") {
    const Scratch scratch;
    const auto points = read(scratch.write("in.ply", typical_ascii));
    const auto losses = write_points_usda(scratch / "a.usda", points, {});
    CHECK(losses.attributes.empty());
    CHECK(losses.width);
    const auto prim = prim_of(scratch / "a.usda");
    const auto& of = prim.properties;
    CHECK(prim.type == "Points");
    REQUIRE(of.at("point3f[] points").items.size() == 3);
    CHECK(of.at("point3f[] points").items[0].texts() == Texts{"0.1", "-2.5", "1e-20"});
    REQUIRE(of.at("vector3f[] velocities").items.size() == 3);
    CHECK(of.at("vector3f[] velocities").items[0].texts() == Texts{"1", "2", "3"});
    CHECK(of.at("vector3f[] velocities").items[2].texts() == Texts{"nan", "5", "6"});
    CHECK(of.at("int[] primvars:red").texts() == Texts{"255", "0", "17"});
    CHECK(of.at("double[] primvars:age").texts() == Texts{"0.30000000000000004", "1e+300", "-0"});
    CHECK(of.at("uint[] primvars:key").texts() == Texts{"4294967295", "0", "12"});
    CHECK(!of.contains("float[] widths"));

    // As a grid of a VDB file, where whole numbers have 64 bits.
    Points in_vdb;
    in_vdb.grid = in_grid(points);
    const auto less = write_points_usda(scratch / "b.usda", in_vdb, {});
    CHECK(less.attributes == Texts{"key"});
    CHECK(!less.width);
    const auto widths = prim_of(scratch / "b.usda");
    CHECK(widths.metadata_of_properties.at("float[] widths").at("interpolation").text ==
          "constant");
    CHECK(widths.properties.at("float[] widths").texts() ==
          Texts{fmt::format("{}", static_cast<float>(in_vdb.grid->voxelSize().x() / 2))});
    CHECK(widths.properties.at("vector3f[] velocities").items.size() == 3);
}

TEST_CASE("points are as wide as their radius says, or as the node is told") {
    const Scratch scratch;
    const auto points = std::make_shared<Points>(
        read(scratch.write("in.ply",
                           "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty "
                           "float y\nproperty float z\nproperty float radius\n"
                           "property int id\nproperty uchar red\nproperty uchar green\nproperty "
                           "uchar blue\nend_header\n"
                           "0 0 0 0.5 7 255 0 51\n1 2 3 0.25 8 0 0 0\n")));
    Told told;
    const std::vector<int> frames{12};
    const auto write = [&](const std::string& name, const std::string& more) {
        NodeBench(points_write(), "{path: " + scratch / name + more + "}")
            .run({{"source", {Payload(points)}}}, Context(told, frames));
    };
    write("a.##.usda", "");
    const auto moving = prim_of(scratch / "a.12.usda");
    const auto sample = [&](const std::string& name) {
        return moving.properties.at(name + ".timeSamples").samples.at(0);
    };
    CHECK(sample("float[] widths").first == 12);
    CHECK(sample("float[] widths").second.texts() == Texts{"1", "0.5"});
    CHECK(moving.metadata_of_properties.at("float[] widths").at("interpolation").text == "vertex");
    CHECK(sample("int64[] ids").second.texts() == Texts{"7", "8"});
    CHECK(sample("color3f[] primvars:displayColor").second.items.at(0).texts() ==
          Texts{"1", "0", "0.2"});

    write("b.usda", ", width: 0.125, translate: [1, 0, 0], scale: 2");
    const auto still = prim_of(scratch / "b.usda");
    CHECK(still.properties.at("float[] widths").texts() == Texts{"0.125"});
    CHECK(still.properties.at("float[] primvars:radius").texts() == Texts{"0.5", "0.25"});
    CHECK(still.properties.at("point3f[] points").items.at(1).texts() == Texts{"0", "1", "1.5"});
    CHECK(told.warnings.empty());
}

TEST_CASE("no two attributes of points take one name") {
    const Scratch scratch;
    const std::string floats =
        "property float v_x\nproperty float v_y\nproperty float v_z\nproperty float "
        "velocity_x\nproperty float velocity_y\n"
        "property float velocity_z\nproperty float pscale\nproperty float radius\nproperty float "
        "a.b\nproperty float a_b\n";
    const auto points =
        read(scratch.write("in.ply",
                           "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty "
                           "float y\nproperty float z\n" +
                               floats + "end_header\n0 0 0 1 2 3 4 5 6 7 8 9 10\n"));
    CHECK(write_points_usda(scratch / "a.usda", points, {}).attributes.empty());
    const auto of = prim_of(scratch / "a.usda").properties;
    CHECK(of.at("vector3f[] velocities").items.at(0).texts() == Texts{"1", "2", "3"});
    CHECK(of.at("float3[] primvars:velocity").items.at(0).texts() == Texts{"4", "5", "6"});
    CHECK(of.at("float[] widths").texts() == Texts{"14"});
    CHECK(of.at("float[] primvars:radius").texts() == Texts{"8"});
    CHECK(of.at("float[] primvars:a_b").texts() == Texts{"9"});
    CHECK(of.at("float[] primvars:a_b_2").texts() == Texts{"10"});
}

TEST_CASE("points without any width are warned of, and what is not for USD is refused") {
    const Scratch scratch;
    const auto points = std::make_shared<Points>(
        read(scratch.write("in.ply",
                           "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty "
                           "float y\nproperty float z\nend_header\n0 0 0\n")));
    Told told;
    const std::vector<int> frames{1};
    NodeBench(points_write(), "{path: " + scratch / "a.usda" + "}")
        .run({{"source", {Payload(points)}}}, Context(told, frames));
    CHECK(told.warnings == Texts{"the .usda file does not state how wide the points are, and "
                                 "they have no voxels: state 'width'"});
    CHECK(NodeBench(points_write(), "{path: a.usda}", {{"beside", 1}}).faults() ==
          "beside: a .usda file holds points alone; write a .vdb, or the grids with vdb.write\n");
    CHECK(NodeBench(points_write(), "{path: a.ply, width: 1}").faults() ==
          "width: is for USD files; the path does not end in .usda\n");
    CHECK(NodeBench(points_write(), "{path: a.usda, encoding: ascii}").faults() ==
          "encoding: is for PLY files; the path does not end in .ply\n");
}
