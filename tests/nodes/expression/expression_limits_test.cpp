#include "carve/energy/volume.h"
#include "carve/field/curl.h"
#include "carve/field/gradient.h"
#include "formats/file/module.h"
#include "formats/vdb/vdb_file.h"
#include "graph/text/yaml_reader.h"
#include "nodes/expression/energy_ax.h"
#include "nodes/expression/evaluate.h"
#include "nodes/expression/field_ax.h"
#include "nodes/expression/program_text.h"
#include "tests/nodes/expression/expression_cases.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/node_bench.h"

#include <tbb/global_control.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <limits>
#include <thread>

using namespace fluidcarve;
using openvdb::Coord;
using test::failure_of;

namespace {

std::string bytes_of(const FloatGrid& grid) { return test::bytes(grid.tree()); }

}  // namespace

TEST_CASE(
    "a program that reads an input as what it is not, or inputs of several transforms, fails with "
    "their names",
    "[expressions]") {
    const auto d = numbers(0, {{{0, 0, 0}, 1}});
    const auto vel = VectorGrid::create();
    vel->tree().setValue({0, 0, 0}, {1, 2, 3});
    CHECK(failure_of([&] {
              energy("@energy = @vel;", {{"vel", any(vel)}});
          }) == "input 'vel' holds vectors, but p.yaml:1:11 reads it as @vel; write v@vel");
    CHECK(failure_of([&] {
              energy("@energy = v@d.x;", {{"d", any(d)}});
          }) == "input 'd' holds numbers, but p.yaml:1:11 reads it as v@d; write @d");
    const auto other = numbers(0, {{{0, 0, 0}, 1}});
    other->setName("heat");
    other->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
    CHECK_THAT(failure_of([&] {
                   energy("@energy = @d + @t;", {{"d", any(d)}, {"t", any(other)}});
               }),
               Catch::StartsWith(
                   "inputs 'd' and 't' have different transforms: 'density' (voxels of 1 x 1 x 1"));
    const auto whole = openvdb::Int32Grid::create();
    CHECK_THAT(failure_of([&] {
                   energy("@energy = @n;", {{"n", any(whole)}});
               }),
               Catch::StartsWith("input 'n' is the grid '' of type int32; programs read numbers"));
}

TEST_CASE("a result that is no energy fails with its lowest voxel", "[expressions]") {
    const auto d = numbers(1, {{{5, 0, 0}, 0}, {{3, 0, 0}, 2}, {{4, 1, 0}, 0}});
    CHECK(failure_of([&] {
              energy("@energy = 1 / @d;", {{"d", any(d)}});
          }) ==
          "@energy is inf at voxel [4, 1, 0]; guard divisions, roots and logarithms against inputs "
          "such as 0 or negative numbers");
    CHECK(failure_of([&] {
              energy("@energy = @d - 1.5f;", {{"d", any(d)}});
          }) ==
          "@energy is -1.5 at voxel [4, 1, 0]; it must be at least 0: use max(..., 0) or abs(...)");
    CHECK(
        energy("@energy = @d - 1.5f;", {{"d", any(d)}}, {}, -std::numeric_limits<float>::infinity())
            ->tree()
            .getValue({5, 0, 0}) == -1.5f);
}

TEST_CASE("a program gives the same bytes whatever the threads, also to several at once",
          "[expressions]") {
    const auto d = FloatGrid::create(0);
    for (int x = 0; x < 40; ++x)
        for (int y = 0; y < 40; ++y)
            for (int z = 0; z < 40; ++z)
                d->tree().setValue({x, y, z}, 0.1f * static_cast<float>(x * y - z));
    const Inputs inputs{{"d", any(d)}};
    const std::string code = "@energy = 2 + sin(@d) + rand(@d) + simplexnoise(@d, getcoordx());";
    std::string alone;
    {
        const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
        alone = bytes_of(*energy(code, inputs));
    }
    const auto program = compiled(code, inputs);
    std::vector<std::string> together(4);
    std::vector<std::thread> threads;
    for (auto& bytes : together)
        threads.emplace_back([&] {
            bytes = bytes_of(*evaluated(module(), *program, inputs, "energy", 0, ~std::uint64_t{0},
                                        [](int, int) { return ""; }));
        });
    for (auto& thread : threads) thread.join();
    for (const auto& bytes : together) CHECK(bytes == alone);
}

TEST_CASE("a place in a program is a place in its YAML, in every style of scalar",
          "[expressions]") {
    const auto place = [](const std::string& yaml, int line, int column) {
        Problems problems;
        const auto value =
            read_yaml(std::make_shared<Source>(Source{"p.yaml", yaml, ""}), problems);
        REQUIRE(problems.empty());
        ValueReader reader(problems, "code", any_number());
        const auto script = ParamTraits<ProgramText>::parse(value.find("code")->value, reader);
        const auto at = script->place(line, column);
        return fmt::format("{}:{}", at.line, at.column);
    };
    // Each holds "@a = 1;" and an "@b = 2;" on another line, or behind it.
    CHECK(place("code: |\n  @a = 1;\n\n  // so\n  @b = 2;\n", 4, 6) == "5:8");
    CHECK(place("code: |\n  @a = 1;\n    @b = 2;\n", 2, 3) == "3:5");
    CHECK(place("x: 1\ncode: |4- # why\n\n      @a = 1;\n      @b = 2;\n", 3, 8) == "5:12");
    CHECK(place("code: \"@a = 1; @b = 2;\"\n", 1, 9) == "1:16");
    CHECK(place("{x: 1, code: '@a = 1; @b = 2;'}\n", 1, 9) == "1:23");
    CHECK(place("code: &it '@a = 1; @b = 2;'\n", 1, 1) == "1:12");
    CHECK(place("code: !!str \"@a = 1;\\n\\\n    \\t@b = 2;\"\n", 2, 2) == "2:7");
    CHECK(place("code: \"'\\\"' \\\\ @b\"\n", 1, 7) == "1:16");
    CHECK(place("code: 'it''s @b'\n", 1, 6) == "1:14");
    CHECK(place("code: >\n  @a = 1;\n  @b = 2;\n\n  @c = 3;\n", 1, 9) == "3:3");
    CHECK(place("code: >\n  @a = 1;\n  @b = 2;\n\n  @c = 3;\n", 2, 6) == "5:8");
    CHECK(place("code: float a = 1;\n  @b = a;\n", 1, 19) == "2:8");
    CHECK(place("code: |\r\n  @a = 1;\r\n  @b = 2;\r\n", 2, 1) == "3:3");
    // What a param stands for is not in the file: the end of what stands before it.
    const auto source =
        std::make_shared<Source>(Source{"p.yaml", "code: \"@a = ${x} + @b\"\n", ""});
    CHECK(ProgramText{"@a = 1.5 + @b", {source, 1, 7}}.place(1, 12).column == 12);
    CHECK(ProgramText{"@a = 1.5 + @b", {source, 1, 7}}.place(1, 2).column == 9);
    // The end, and beyond it.
    CHECK(place("code: |\n  @a = 1\n\nx: 1\n", 2, 1) == "2:9");
    CHECK(place("code: \"@a = 1\"\n", 1, 7) == "1:14");
    CHECK(place("code: \"@a = 1\"\n", 0, 0) == "1:7");
}
