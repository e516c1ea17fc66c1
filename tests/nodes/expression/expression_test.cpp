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

using namespace fluidcarve;
using openvdb::Coord;
using test::failure_of;

namespace {

/// "line:column message", a line for each fault.
std::string faults_of(const std::string& code,
                      const std::vector<std::string>& inputs = {"d", "vel"},
                      const Constants& constants = {}) {
    std::vector<ExpressionFault> faults;
    const auto made = module().compile({code, inputs, constants, "energy"}, faults);
    CHECK((made == nullptr) ==
          std::ranges::any_of(faults, [](const auto& fault) { return !fault.warning; }));
    std::string out;
    for (const auto& fault : faults) {
        // Tests that are about something else need not read every input.
        if (fault.warning) continue;
        out += (out.empty() ? "" : "\n") +
               (fault.line > 0 ? fmt::format("{}:{} {}", fault.line, fault.column, fault.message)
                               : fault.field + " " + fault.message);
    }
    return out;
}

/// The value of a program that reads nothing of interest.
float value_of(const std::string& code, float d = 1, const Constants& constants = {}) {
    const auto grid = numbers(0, {{{0, 0, 0}, d}});
    return energy("float unused = @d; " + code, {{"d", any(grid)}}, constants,
                  -std::numeric_limits<float>::infinity())
        ->tree()
        .getValue({0, 0, 0});
}

}  // namespace

TEST_CASE("the paper's energy of smoke, eq. 10, as a program, is that of energy.volume",
          "[expressions]") {
    const auto volume = read_vdb(TEST_DATA "/plume/plume.0053.vdb");
    const auto velocity = openvdb::gridConstPtrCast<VectorGrid>(volume.find("velocity"));
    const auto density = openvdb::gridConstPtrCast<FloatGrid>(volume.find("density"));
    const VolumeWeights weights{1, 0.5f, 0.25f};
    auto terms = volume_terms(velocity, {density}, weights);
    terms[0].range = {0, 40};
    terms[1].range = {0, 300};
    terms[2].range = {0, 2};
    const auto expected = combined_energy(terms);
    const auto result = energy(
        "@energy = min(length(v@curl) / 40, 1.0f)\n"
        "  + $lambda1 * min(dot(v@u, v@u) / 300, 1.0f)\n"
        "  + $lambda2 * min(length(v@slope) / 2, 1.0f);",
        {{"curl", any(curl_field(velocity))},
         {"u", any(velocity)},
         {"slope", any(gradient_field(*density))}},
        {{"lambda1", 0.5}, {"lambda2", 0.25}});
    CHECK(result->tree().hasSameTopology(expected->tree()));
    CHECK(result->transform() == expected->transform());
    float worst = 0, largest = 0;
    for (auto value = expected->cbeginValueOn(); value; ++value) {
        worst = std::max(worst, std::abs(result->tree().getValue(value.getCoord()) - *value));
        largest = std::max(largest, *value);
    }
    CHECK(largest > 0.5f);
    CHECK(worst < 1e-4f);
}

TEST_CASE("a program protects hot smoke only", "[expressions]") {
    const auto smoke =
        numbers(0, {{{0, 0, 0}, 0.8f}, {{1, 0, 0}, 0.8f}, {{2, 0, 0}, 0.01f}, {{3, 0, 0}, 0.8f}});
    const auto heat = numbers(0, {{{0, 0, 0}, 2.0f}, {{1, 0, 0}, 0.5f}, {{2, 0, 0}, 2.0f}});
    const auto result = energy("@energy = @smoke > 0.02f && @heat >= $hot ? @smoke * @heat : 0;",
                               {{"smoke", any(smoke)}, {"heat", any(heat)}}, {{"hot", 1.0}});
    CHECK(result->tree().getValue({0, 0, 0}) == Approx(1.6));
    for (const int x : {1, 2, 3}) CHECK(result->tree().getValue({x, 0, 0}) == 0);
    CHECK(result->activeVoxelCount() == 4);
}

TEST_CASE(
    "a program runs where any input is active, and beyond its voxels an input has what it holds "
    "there",
    "[expressions]") {
    const auto d = numbers(0.5f, {{{0, 0, 0}, 3}, {{1, 0, 0}, 4}});
    const auto vel = VectorGrid::create(openvdb::Vec3s(0, 0, 2));
    vel->tree().setValue({1, 0, 0}, {3, 4, 0});
    vel->tree().setValue({9, 9, 9}, {6, 8, 0});
    const auto result =
        energy("@energy = abs(@d) + length(v@vel);", {{"d", any(d)}, {"vel", any(vel)}});
    CHECK(result->activeVoxelCount() == 3);
    CHECK(result->tree().getValue({0, 0, 0}) == 5);
    CHECK(result->tree().getValue({1, 0, 0}) == 9);
    CHECK(result->tree().getValue({9, 9, 9}) == 10.5f);
    CHECK(result->background() == 0);
    CHECK(result->getName() == "energy");
    // An argument counts as written, in AX: it must not be.
    CHECK(d->tree().getValue({0, 0, 0}) == 3);
    CHECK(d->activeVoxelCount() == 2);
    CHECK(d->getName() == "density");
}

TEST_CASE("a mask reads as 1 and 0, a staggered velocity at the voxels' centres", "[expressions]") {
    const auto mask = MaskGrid::create();
    mask->tree().setValueOn({0, 0, 0});
    const auto vel = VectorGrid::create();
    vel->setGridClass(openvdb::GRID_STAGGERED);
    vel->tree().setValue({0, 0, 0}, {2, 0, 0});
    vel->tree().setValue({1, 0, 0}, {4, 0, 0});
    const auto result =
        energy("@energy = v@vel.x + 10 * @m;", {{"vel", any(vel)}, {"m", any(mask)}});
    CHECK(result->tree().getValue({0, 0, 0}) == 13);
    CHECK(result->tree().getValue({1, 0, 0}) == 2);
}

TEST_CASE("a tile stays one, unless the program asks where it is", "[expressions]") {
    const auto d = FloatGrid::create(0);
    d->tree().addTile(1, {8, 0, 0}, 2, true);
    d->tree().setValue({0, 0, 0}, 5);
    d->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
    const auto same = energy("@energy = 3 * @d;", {{"d", any(d)}});
    CHECK(same->tree().activeTileCount() == 1);
    CHECK(same->tree().getValue({9, 1, 1}) == 6);
    CHECK(same->tree().getValue({0, 0, 0}) == 15);
    const std::string by_place = "vec3d p = getvoxelpws(); @energy = @d * p.x + getcoordy();";
    const auto placed = energy(by_place, {{"d", any(d)}});
    CHECK(placed->tree().activeTileCount() == 0);
    CHECK(placed->activeVoxelCount() == 513);
    CHECK(placed->tree().getValue({9, 3, 1}) == 2 * 4.5f + 3);
    CHECK(failure_of([&] {
              energy(by_place, {{"d", any(d)}}, {}, 0, 1000);
          }) ==
          "the program reads voxel positions, so each of 513 voxels, also of those in tiles, needs "
          "its own value: 0.0 GiB, but --memory allows 0.0");
}

TEST_CASE("params are numbers and vectors", "[expressions]") {
    CHECK(value_of("@energy = $gain + dot(v$axis, {1, 10, 100});", 1,
                   {{"gain", 0.5}, {"axis", Vec3{1, 2, 3}}}) == 321.5f);
    CHECK(ParamTraits<ProgramConstant>::text(0.5) == "0.5");
    CHECK(ParamTraits<ProgramConstant>::text(Vec3{1, 2.5, 3}) == "[1, 2.5, 3]");
}

TEST_CASE("a program's value is what AX says", "[expressions]") {
    CHECK(value_of("if (@d > 0.5f) { @energy = 1; } else { @energy = 2; }") == 1);
    CHECK(value_of("@energy = 3; if (@d > 0.5f) return; @energy = 4;") == 3);
    CHECK(value_of("float s; for (int i = 1; i <= 4; ++i) { if (i == 3) continue; s += i; } "
                   "@energy = s;") == 7);
    CHECK(value_of("for (int i = 6; i > 0; i -= 2) for (int j = 0; j < $n; j++) @energy += 1;", 1,
                   {{"n", 4.0}}) == 12);
    CHECK(value_of("for (int i = 3; i < 0; ++i) @energy = 9;") == 0);
    CHECK(value_of("@energy = 7 / 2; @energy += 7 % 4;") == 6);
    CHECK(value_of("float d = 5; { float d = 2; @energy += d; } @energy += d;") == 7);
    CHECK(value_of("@energy = rand(@d);") == value_of("@energy = rand(@d);"));
    CHECK(value_of("vec3f v = {1, 2, 3}; v.y = 5; @energy = v[0] + v.y + v.b;") == 9);
}

TEST_CASE("a whole exponent, which would crash AX, is as good as any", "[expressions]") {
    CHECK(value_of("@energy = pow(2.5, 2) + pow(@d, getcoordx() + 1) + pow(3, 2) + pow(pow(2.0, "
                   "2), 0.5f);",
                   4) == Approx(6.25 + 4 + 9 + 2));
}

TEST_CASE("a variable without a value is 0", "[expressions]") {
    CHECK(value_of("float a; vec3f v; int i; @energy = a + v.x + i + 1;") == 1);
}

TEST_CASE(
    "a cast that would crash AX is refused at its place, or harmless where its value's type is not "
    "known beforehand",
    "[expressions]") {
    const auto redundant = [](const std::string& place, const std::string& type) {
        return place + " the cast is redundant: the value is " + type + " already; leave it out";
    };
    CHECK(faults_of("@energy = float(@d);") == redundant("1:11", "float"));
    CHECK(faults_of("vec3f v = v@vel;\n@energy = 2 + float(v.x);") == redundant("2:15", "float"));
    CHECK(faults_of("@energy = float(v@vel.x);") == redundant("1:11", "float"));
    CHECK(faults_of("int i = 3; @energy = int(i + 1);") == redundant("1:22", "int32"));
    CHECK(faults_of("@energy = float(1.0f);") == redundant("1:11", "float"));
    CHECK(faults_of("@energy = float(-@d);") == redundant("1:11", "float"));
    CHECK(faults_of("float a; @energy = float(a = 3);") == redundant("1:20", "float"));
    CHECK(faults_of("float a; @energy = float(a++);") == redundant("1:20", "float"));
    CHECK(faults_of("@energy = float(@d > 1 ? @d : 2.0f);") == redundant("1:11", "float"));
    CHECK(faults_of("@energy = bool(@d > 1);") == redundant("1:11", "bool"));
    CHECK(faults_of("@energy = float((1, 2.5f));") == redundant("1:11", "float"));
    CHECK(faults_of("@energy = float($g);", {"d"}, {{"g", 1.0}}) == redundant("1:11", "float"));
    CHECK(value_of("@energy = float(abs(@d));", -2) == 2);
    CHECK(value_of("@energy = int(@d) + int(2.7f);", 1.9f) == 3);
    CHECK(value_of("@energy = int(int(@d) * 1.5f);", 3) == 4);
    CHECK(value_of("bool b = true; @energy = int(b + b) + float(floor(2.5f));") > 2);
}

TEST_CASE("a loop that may not end is refused, and so are those that take too long",
          "[expressions]") {
    const auto endless = [](const std::string& place, const std::string& kind) {
        return place + " '" + kind +
               "' may never end; count to a stated end, as in for (int i = 0; i < 10; ++i), and "
               "leave it early by break";
    };
    CHECK(faults_of("@energy = 1; while (true) @energy = 2;") == endless("1:14", "while"));
    CHECK(faults_of("@energy = 1; do { @energy += 1; } while (@energy < 9);") ==
          endless("1:14", "do"));
    for (const auto* const loop :
         {"for (;;)", "for (int i = 0; ; ++i)", "for (int i = 0; i < 9;)",
          "for (int i = 0; i < 9; --i)", "for (int i = 9; i > 0; ++i)",
          "for (int i = 0; i < @d; ++i)", "for (int i = 0; i < 9; i += 0)",
          "for (int i = 0; i != 9; ++i)", "for (float i = 0; i < 9; i += 1)",
          "int n = 9; for (int i = 0; i < n; ++i)", "int i; for (i = 0; i < 9; ++i)",
          "for (int i = 2147483640; i <= 2147483647; ++i)", "int j; for (int i = 0; i < 9; ++j)"}) {
        INFO(loop);
        CHECK_THAT(faults_of(std::string("@energy = 1; ") + loop + " { @energy = 2; }"),
                   Catch::Contains("'for' may never end"));
    }
    CHECK(faults_of("for (int i = 0; i < 9; ++i) { @energy = 2; i = 0; }") ==
          "1:44 'i' counts a loop and can't be changed inside it");
    CHECK(faults_of("for (int i = 0; i < 9; ++i) { @energy = i--; }") ==
          "1:41 'i' counts a loop and can't be changed inside it");
    CHECK(faults_of("for (int i = 0; i < 9; ++i)\n for (int i = 0; i < 9; ++i) @energy = 1;") ==
          "2:2 'i' already counts a loop around this one; give this loop's counter another name");
    CHECK(
        faults_of("for (int i = 0; i < 101; ++i)\n  for (int j = 0; j < 100; ++j) @energy = 1;") ==
        "2:3 the loops run 10201 times for each voxel; 10000 are the most");
    CHECK(faults_of("for (int i = 0; i < 99; ++i)\n  for (int j = 0; j < 100; ++j) @energy = 1;") ==
          "");
}

TEST_CASE("what would trap or reach beyond memory is refused at its place", "[expressions]") {
    const std::string divisor =
        " a whole number can't be divided by one that may be 0; make one of them a fraction: 1.0f "
        "* a / b";
    CHECK(faults_of("int i = @d;\n@energy = 5 / i;") == "2:15" + divisor);
    CHECK(faults_of("int i = @d; @energy = 5 % i;") == "1:27" + divisor);
    CHECK(faults_of("int i = @d; i /= i; @energy = i;") == "1:18" + divisor);
    CHECK(faults_of("vec3i v = v@vel; int i; v /= i; @energy = 1;") == "1:30" + divisor);
    CHECK(faults_of("@energy = 5 / (3 - 3);") == "1:16" + divisor);
    CHECK(faults_of("@energy = floormod(5, int(@d));") == "1:23" + divisor);
    CHECK(faults_of("int i = @d; @energy = 1.0f * 5 / i + 5 / @d + i / 2 + i / 2.0f;") == "");
    const std::string index =
        " a component is .x, .y, .z or [0], [1], [2]; other indices are not supported";
    CHECK(faults_of("@energy = v@vel[3];") == "1:11" + index);
    CHECK(faults_of("int i = @d; vec3f v; v[i] = 1; @energy = v.x;") == "1:22" + index);
    CHECK(faults_of("float a = external(\"d\"); @energy = a;").substr(0, 4) == "1:20");
}

TEST_CASE("what differs from run to run, prints or is of no use is refused", "[expressions]") {
    CHECK(faults_of("@energy = rand();") ==
          "1:11 rand needs a seed, as in rand(@density): without one no two runs are the same");
    CHECK_THAT(faults_of("print(1); @energy = 1;"),
               Catch::StartsWith("1:1 there is no function 'print'"));
    CHECK(faults_of("@energy = sqr(@d);") ==
          "1:11 there is no function 'sqr'; did you mean 'sqrt'?");
    CHECK(faults_of("@energy = 1 << 40;") == "1:11 bit shifts are not supported");
    CHECK(faults_of("mat3f m; @energy = 1;") ==
          "1:1 the type 'mat3f' is not supported; use float, vec3f, int, bool, double, vec3d, "
          "vec3i or int64");
}

TEST_CASE("names that are not there, and names that nothing reads, are told", "[expressions]") {
    CHECK(faults_of("@energy = @vle + @d;") == "1:11 '@vle' is no input; did you mean 'vel'?");
    CHECK(faults_of("@energy = $gian;", {}, {{"gain", 1.0}}) ==
          "1:11 '$gian' is not among the params; did you mean 'gain'?");
    CHECK(faults_of("float e = @d;") == "code never writes @energy");
    CHECK(faults_of("") == "code never writes @energy");
    CHECK(faults_of("@enrgy = @d;") == "1:1 '@enrgy' can't be written to; write to @energy");
    CHECK(faults_of("@d = 2; @energy = 1;") == "1:1 '@d' can't be written to; write to @energy");
    CHECK(faults_of("v@vel.x += 2; @energy = 1; @d++;") ==
          "1:1 '@vel' can't be written to; write to @energy\n1:28 '@d' can't be written to; write "
          "to @energy");
    CHECK(faults_of("v@energy = 2;") == "1:1 @energy is a number, not 'vec3f@energy'");
    CHECK(faults_of("@energy = @d + v@d.x;") ==
          "1:16 'd' is read as @d and as v@d; it can't be both");
    CHECK(faults_of("@energy = i@d;") ==
          "1:11 an input can't be read as 'int32@d'; write @d (numbers, masks) or v@d (vectors)");
    CHECK(faults_of("vec3f v = v$gain; @energy = v.x;", {}, {{"gain", 1.0}}) ==
          "1:11 'gain' is a number: write $gain");
    CHECK(faults_of("@energy = energy;", {}) ==
          "1:11 there is no variable 'energy'; write @energy for the output");
    CHECK(faults_of("@energy = d;") ==
          "1:11 there is no variable 'd'; write @d or v@d for the input");
    CHECK(faults_of("@energy = gain;", {}, {{"gain", 1.0}}) ==
          "1:11 there is no variable 'gain'; write $gain or v$gain for the param");
    CHECK(faults_of("@energy = @d;", {"d", "energy"}) ==
          "inputs can't have the name 'energy': it is the output's name");
}

TEST_CASE("an input or a constant that nothing reads is warned of, if the program is good",
          "[expressions]") {
    std::vector<ExpressionFault> warnings, faults;
    CHECK(module().compile({"@energy = @d;", {"d", "vel"}, {{"gain", 1.0}}, "energy"}, warnings));
    std::string all;
    for (const auto& each : warnings)
        all += fmt::format("{} {} {}\n", each.warning, each.field, each.message);
    CHECK(all ==
          "true inputs has 'vel', which the program never reads\ntrue params has 'gain', which the "
          "program never reads\n");
    CHECK(!module().compile({"@energy = @d + @vle;", {"d", "vel"}, {{"gain", 1.0}}, "energy"},
                            faults));
    REQUIRE(faults.size() == 1);
    CHECK(faults[0].message == "'@vle' is no input; did you mean 'vel'?");
}

TEST_CASE("a mistake is told once, however often it is made, and what follows from it is not told",
          "[expressions]") {
    CHECK(faults_of("float speed = length(v@vel);\n@energy = sped * sped + sped;") ==
          "2:11 there is no variable 'sped'; did you mean 'speed'?");
    CHECK(faults_of("speed = 2; @energy = speed; { speed = 3; }") ==
          "1:1 there is no variable 'speed'");
    CHECK(faults_of("@energy = @dd + @dd * @dd;") == "1:11 '@dd' is no input; did you mean 'd'?");
    CHECK(faults_of("@energy = $g + $g;", {}, {{"gain", 1.0}}) ==
          "1:11 '$g' is not among the params; known: gain");
    CHECK(faults_of("@energy = sqr(@d) + sqr(2.0f);") ==
          "1:11 there is no function 'sqr'; did you mean 'sqrt'?");
    CHECK(faults_of("@enrgy = 1; @enrgy += 2; @energy = @enrgy;") ==
          "1:1 '@enrgy' can't be written to; write to @energy");
    CHECK(faults_of("@energy = @d + v@d.x + v@d.y;") ==
          "1:16 'd' is read as @d and as v@d; it can't be both");
    CHECK(faults_of("float speed = v@vel;\n@energy = length(speed);") ==
          "1:1 cannot assign a scalar value from a vector or matrix. Consider using the [] "
          "operator to get a particular element");
    // The loop's body writes the output.
    CHECK(faults_of("while (true) { @energy = 1; }") ==
          "1:1 'while' may never end; count to a stated end, as in for (int i = 0; i < 10; ++i), "
          "and leave it early by break");
    // These are two mistakes.
    CHECK(
        faults_of("@energy = sqr(@d) + sped;") ==
        "1:11 there is no function 'sqr'; did you mean 'sqrt'?\n1:21 there is no variable 'sped'");
}

TEST_CASE("a program reads the frame and its time, unless an input or a constant has the name",
          "[expressions]") {
    const auto d = numbers(0, {{{0, 0, 0}, 3}});
    // The value at frame 25, with or without a grid 'Frame' that holds 7.
    const auto at_25 = [&](const std::string& yaml, bool named = false) {
        auto type = field_ax();
        const auto params = type.make_params();
        Problems problems;
        for (const auto& field :
             read_yaml(std::make_shared<Source>(Source{"p.yaml", yaml, ""}), problems).fields) {
            ValueReader reader(problems, field.name, type.param(field.name)->range);
            REQUIRE(type.param(field.name)->parse(params.get(), field.value, reader));
        }
        CHECK(type.traits(params.get()).animates == true);
        const auto behaviour = type.bind(params);
        const auto ports = behaviour.make_ports();
        std::vector<Payload> grids{Payload(any(d))};
        if (named) grids.emplace_back(any(numbers(7, {})));
        type.input("inputs")->set(
            ports.get(), grids,
            named ? std::vector<std::string>{"d", "Frame"} : std::vector<std::string>{"d"});
        Context::Host host;
        const std::vector<int> frames{24, 25};
        auto context = Context(host, frames).at(1);
        behaviour.run(ports.get(), context);
        const auto out = type.outputs.front().get(ports.get()).as<FloatGrid>();
        CHECK(out->activeVoxelCount() == 1);
        return out->tree().getValue({0, 0, 0});
    };
    CHECK(at_25("code: '@out = @d + @Frame;'") == 28);
    CHECK(at_25("code: '@out = $F * @d;'") == 75);
    CHECK(at_25("code: '@out = @Time;'") == 1);
    CHECK(at_25("{code: '@out = @Time;', params: {fps: 48}}") == 0.5f);
    CHECK(at_25("{code: '@out = $F + @Frame;', params: {F: 2}}", true) == 9);
    CHECK(faults_of("@energy = v@Time.x;") == "1:11 'Time' is a number: write @Time");
    CHECK(faults_of("@Frame = 1; @energy = 1;") ==
          "1:1 '@Frame' can't be written to; write to @energy");
    CHECK(test::NodeBench(field_ax(), "{code: '@out = @Time;', params: {fps: 0}}", {{"inputs", 1}})
              .faults() == "params: 'fps' must be a number above 0, for the program reads @Time\n");
}

TEST_CASE("energy.ax has an energy of its own where no input is active", "[expressions]") {
    const auto type = energy_ax();
    const auto d = numbers(0, {{{0, 0, 0}, 3}, {{1, 0, 0}, 0}});
    const auto made = [&](const std::string& yaml) {
        Problems problems;
        const auto params = type.make_params();
        const auto fields =
            read_yaml(std::make_shared<Source>(Source{"p.yaml", yaml, ""}), problems);
        for (const auto& field : fields.fields) {
            ValueReader reader(problems, field.name, type.param(field.name)->range);
            REQUIRE(type.param(field.name)->parse(params.get(), field.value, reader));
        }
        const auto behaviour = type.bind(params);
        const auto ports = behaviour.make_ports();
        type.input("inputs")->set(ports.get(), {Payload(any(d))}, {"d"});
        Context context;
        behaviour.run(ports.get(), context);
        return type.outputs.front().get(ports.get()).as<FloatGrid>();
    };
    const auto plain = made("code: '@energy = 2 * @d;'"),
               dear = made("{code: '@energy = 2 * @d;', outside: 1.5}");
    CHECK(plain->background() == 0);
    CHECK(dear->background() == 1.5f);
    for (const auto& grid : {plain, dear}) {
        CHECK(grid->activeVoxelCount() == 2);
        CHECK(grid->tree().getValue({0, 0, 0}) == 6);
        CHECK(grid->tree().getValue({1, 0, 0}) == 0);
    }
    // In a leaf of active voxels, and far away.
    for (const auto& at : {Coord(2, 0, 0), Coord(900, 0, 0)}) {
        CHECK(plain->tree().getValue(at) == 0);
        CHECK(dear->tree().getValue(at) == 1.5f);
    }
}

TEST_CASE("what the parser and the compiler say bears its place", "[expressions]") {
    CHECK(faults_of("@energy = 1 +;") == "1:14 unexpected ';'");
    CHECK(faults_of("@energy = 1") == "1:11 unexpected end of file, expecting ';'");
    CHECK(faults_of("float a = 1;\n\n  vec3f v = 2; @energy = a * v;", {}) ==
          "3:16 cannot assign a scalar value from a vector or matrix. Consider using the [] "
          "operator to get a particular element");
    CHECK_THAT(
        faults_of("@energy =\n  length(2.0f);", {}),
        Catch::StartsWith(
            "2:3 no matching function for void length(float); known: double length(vec2d v), "));
    CHECK(faults_of("@energy = 1;" + std::string(20'000, ' ')) ==
          "code has 20012 bytes; 16384 are the most");
    std::string deep = "@energy = ";
    for (int n = 0; n < 4000; ++n) deep += "1+";
    CHECK_THAT(faults_of(deep + "1;"), Catch::Contains("nested more than 100 levels deep"));
    // More than the parser itself takes.
    CHECK_THAT(faults_of("@energy = " + std::string(12'000, '(') + "1;"),
               Catch::EndsWith(" nested too deep"));
}
