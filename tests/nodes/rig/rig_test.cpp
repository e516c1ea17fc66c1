#include "nodes/rig.h"
#include "carve/base/failure.h"
#include "carve/rig/advect.h"
#include "carve/rig/circle.h"
#include "carve/rig/points.h"
#include "carve/rig/transform.h"
#include "formats/geometry_file/curve_file.h"
#include "tests/support/node_bench.h"
#include "tests/support/sampled.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

#include <sys/stat.h>
#include <cmath>
#include <filesystem>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

namespace {

Rig made(NodeBench&& bench, int frame = 1) {
    const std::vector<int> frames{frame};
    Context::Host host;
    return *bench.run({}, Context(host, frames).at(0)).at("rig").as<Rig>();
}

Rig through(std::vector<Vec3d> points, bool closed = false) {
    Rig out;
    out.points = std::move(points);
    out.closed = closed;
    return out;
}

std::string fault_in(const Scratch& folder, const std::string& name, const std::string& text) {
    const auto path = folder.write(name, text);
    const auto message = failure_of([&] { read_curve(path); });
    return message.starts_with(path) ? message.substr(path.size()) : message;
}

/// The rig of rig.advect over some frames of one velocity.
Rig advected(const std::string& yaml, const VectorGrid::Ptr& velocity,
             const std::vector<int>& frames) {
    NodeBench bench(rig_advect(), yaml);
    REQUIRE(bench.faults().empty());
    Context::Host host;
    for (std::size_t t = 0; t < frames.size(); ++t)
        bench.add({{"velocity", {Payload(velocity)}}}, Context(host, frames).at(t));
    return *bench.gathered({}).at("rig").as<Rig>();
}

}  // namespace

TEST_CASE("rig.points runs through its points, closed or open") {
    const auto rig = made(NodeBench(
        rig_points(), "{points: [[0, 0, 0], [0, 4, 0], [1, 6, 0]], closed: true, up: [1, 0, 0]}"));
    CHECK(rig.points == std::vector<Vec3d>{{0, 0, 0}, {0, 4, 0}, {1, 6, 0}});
    CHECK(rig.closed);
    CHECK(rig.up == Vec3d(1, 0, 0));
}

TEST_CASE(
    "rig.points that states points for some frames moves straight from one to the next, and stands "
    "before and behind") {
    const std::string yaml =
        "{frames: {10: [[0, 0, 0], [0, 4, 0]], 20: [[1, 0, 0], [2, 4, 0]], -3: [[5, 0, 0], [9, 0, "
        "0], [9, 9, 9]]}}";
    const auto points = [&](int frame) {
        return made(NodeBench(rig_points(), yaml), frame).points;
    };
    CHECK(points(15) == std::vector<Vec3d>{{0.5, 0, 0}, {1, 4, 0}});
    CHECK(points(20) == std::vector<Vec3d>{{1, 0, 0}, {2, 4, 0}});
    CHECK(points(99) == points(20));
    CHECK(points(-3).size() == 3);
    CHECK(points(-9) == points(-3));
    CHECK(failure_of([&] { points(0); }) ==
          "the rig has 3 points in frame -3, but 2 in frame 10: between two frames of different "
          "numbers it is not known");
}

TEST_CASE("rig.points says what is wrong with its points before a run") {
    const auto faults = [](const std::string& yaml) {
        return NodeBench(rig_points(), yaml).faults();
    };
    CHECK(faults("{points: [[0, 0, 0]]}") ==
          "points: 'points' is no path: a rig needs at least 2 points, not 1\n");
    CHECK(faults("{points: [[0, 0, 0], [1, 0, 0]], closed: true}") ==
          "points: 'points' is no path: a closed rig needs at least 3 points, not 2\n");
    CHECK(faults("{points: [[0, 0, 0], [1, 2, 3], [1, 2, 3]]}") ==
          "points: 'points' is no path: points 2 and 3 of the rig are the same, (1, 2, 3)\n");
    CHECK(faults("{points: [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 0, 0]], closed: true}") ==
          "points: 'points' is no path: points 4 and 1 of the rig are the same, (0, 0, 0); a "
          "closed rig returns to its first point by itself\n");
    CHECK(faults("{points: [[0, 0, 0], [4, 0, 0], [2, 0, 0]]}") ==
          "points: 'points' is no path: the rig turns right back at point 2, (4, 0, 0)\n");
    CHECK(faults("{points: [[0, 0, 0], [4, 0, 0]], up: [0, 0, 0]}") ==
          "up: 'up' has no direction\n");
    CHECK(faults("{}") ==
          "points: needs either 'points', or 'frames' with points for each, and not both\n");
    CHECK(faults("{points: [[0, 0, 0], [1, 0, 0]], frames: {1: [[0, 0, 0], [1, 0, 0]]}}") ==
          "frames: needs either 'points', or 'frames' with points for each, and not both\n");
    CHECK(faults("{frames: {1: [[0, 0, 0]], b: [[0, 0, 0], [1, 0, 0]]}}") ==
          "frames: 'frames' is no path in frame 1: a rig needs at least 2 points, not 1\n"
          "frames: 'frames' needs a frame's number before each list of points, not 'b'\n");
}

TEST_CASE(
    "rig.circle runs clockwise seen from its normal's tip, from x towards minus y if that is z") {
    const auto rig = made(NodeBench(rig_circle(), "{center: [1, 2, 3], radius: 2}"));
    CHECK(rig.closed);
    CHECK(rig.up == Vec3d(0, 0, 1));
    CHECK((rig.points.front() - Vec3d(3, 2, 3)).length() < 1e-15);
    CHECK((rig.points[rig.points.size() / 4] - Vec3d(1, 0, 3)).length() < 1e-12);
    for (const auto& point : rig.points)
        CHECK((point - Vec3d(1, 2, 3)).length() == Approx(2).epsilon(1e-14));

    const auto started = made(NodeBench(
        rig_circle(), "{center: [0, 0, 0], normal: [0, 3, 0], radius: [2, 1], start: 90}"));
    CHECK(started.up == Vec3d(0, 1, 0));
    CHECK((started.points.front() - Vec3d(0, 0, 1)).length() < 1e-15);
    CHECK((started.points[started.points.size() / 4] - Vec3d(-2, 0, 0)).length() < 1e-12);
    // At any angle, neighbours stand as far apart.
    for (const std::string start : {"-1e9", "1e20", "1e308"}) {
        const auto turned =
            made(NodeBench(rig_circle(), "{center: [0, 0, 0], radius: 2, start: " + start + "}"));
        CHECK((turned.points[1] - turned.points[0]).length() ==
              Approx((rig.points[1] - rig.points[0]).length()));
    }
    CHECK((made(NodeBench(rig_circle(), "{center: [0, 0, 0], normal: [-1, 0, 0], radius: 1}"))
               .points.front() -
           Vec3d(0, 1, 0))
              .length() < 1e-15);
}

TEST_CASE("rig.circle says what is wrong with it") {
    const auto faults = [](const std::string& yaml) {
        return NodeBench(rig_circle(), yaml).faults();
    };
    CHECK(faults("{center: [0, 0, 0], radius: 0}") == "radius: 'radius' must be more than 0\n");
    CHECK(faults("{center: [0, 0, 0], radius: [1, 0]}") ==
          "radius: 'radius' must be more than 0\n");
    CHECK(faults("{center: [0, 0, 0], radius: [1, 2, 3]}") ==
          "radius must have one number or two, not 3\n");
    CHECK(faults("{center: [0, 0, 0], radius: -1}") == "radius must be at least 0, not -1\n");
    CHECK(faults("{center: [0, 0, 0], radius: 1, normal: [0, 0, 0]}") ==
          "normal: 'normal' has no direction\n");
}

TEST_CASE("a curve is read from the lines of an OBJ, in one piece or in many") {
    const Scratch folder;
    const std::string vertices =
        "# a curve\r\nv 0 0 0\r\nv 1 0 0 1.0\r\nv 2 0 +1e-1\r\n\r\nv 3 1 0\r\n";
    const std::vector<Vec3d> all{{0, 0, 0}, {1, 0, 0}, {2, 0, 0.1}, {3, 1, 0}};
    CHECK(read_curve(folder.write("one.obj", vertices + "l 1 2 3 4\r\n")) == all);
    CHECK(read_curve(folder.write("back.OBJ", vertices + "l -4/1 -3/2 -2 -1")) == all);
    CHECK(read_curve(folder.write("pieces.obj", vertices + "l 2 3\nl 2 1\nl 3 4\n")) == all);
    CHECK(read_curve(folder.write("loop.obj", vertices + "l 1 2 3 4 1\n")) ==
          std::vector<Vec3d>{all[0], all[1], all[2], all[3], all[0]});
    CHECK(read_curve(folder.write("loop_pieces.obj", vertices + "l 3 4\nl 1 2\nl 4 1\nl 2 3\n")) ==
          std::vector<Vec3d>{all[2], all[3], all[0], all[1], all[2]});
}

TEST_CASE("a curve is read from the points of an ascii PLY and of a CSV") {
    const Scratch folder;
    const std::vector<Vec3d> all{{1, 2, 3}, {4, 5, 6}};
    CHECK(
        read_curve(folder.write("a.ply",
                                "ply\nformat ascii 1.0\ncomment x\nelement other 1\nproperty int "
                                "n\nelement vertex 2\nproperty float z\nproperty float x\n"
                                "property float y\nelement edge 1\nproperty int vertex1\nproperty "
                                "int vertex2\nend_header\n7\n3 1 2\n6 4 5\n0 1\n")) == all);
    CHECK(read_curve(folder.write("a.csv", "1,2,3\n\n# between\n4, 5, 6 # behind\n")) == all);
    CHECK(read_curve(folder.write("b.csv", "id;Z;X;Y\r\n0;3;1;2\r\n1;6;4;5\r\n")) == all);
    CHECK(read_curve(folder.write("c.csv", "1 2 3 9\n4\t5\t6 9")) == all);
}

TEST_CASE("a curve that can't be read names file and line") {
    const Scratch folder;
    CHECK(fault_in(folder, "a.obj", "v 0 0 0\nv 1 zero 0\n") == ":2: 'zero' is no number");
    CHECK(fault_in(folder, "a.obj", "v 0 0\n") == ":1: this point lacks a coordinate");
    CHECK(fault_in(folder, "a.obj", "v 0 0 0\nv 1 1 1\nl 1 3\n") ==
          ":3: '3' is none of the 2 vertices above");
    CHECK(fault_in(folder, "a.obj", "v 0 0 0\nv 1 1 1\nl 0 1\n") ==
          ":3: '0' is none of the 2 vertices above");
    CHECK(fault_in(folder, "a.obj", "v 0 0 0\nl 1\n") == ":2: a line needs at least two vertices");
    CHECK(fault_in(folder, "a.obj", "v 0 0 0\nf 1 1 1\n") ==
          ": there is no line in it (element 'l'): export a curve as lines, not as faces");
    CHECK(fault_in(folder, "a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nl 1 2\nl 3 4\n") ==
          ":6: this line is not joined to the first one: a rig is one line");
    CHECK(fault_in(folder, "a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nl 1 2 3\nl 2 4\n") ==
          ":6: a third line ends at vertex 2: a rig is one line without branches");
    CHECK(fault_in(folder, "a.ply", "solid\n") ==
          ":1: this is no PLY file: its first line is not 'ply'");
    CHECK(fault_in(folder, "a.ply", "ply\nformat binary_little_endian 1.0\n") ==
          ":2: only PLY files of format ascii can be read here");
    CHECK(fault_in(folder, "a.ply", "ply\nformat ascii 1.0\nelement vertex 2\n") ==
          ":3: the header has no 'end_header'");
    CHECK(fault_in(folder, "a.ply", "ply\nformat ascii 1.0\nelement vertex\n") ==
          ":3: an element needs a name and a count");
    CHECK(fault_in(folder, "a.ply", "ply\nelement vertex 1\nproperty list uchar int a\n") ==
          ":3: a vertex with a list among its properties can't be read here");
    CHECK(fault_in(folder, "a.ply",
                   "ply\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n") ==
          ":5: element 'vertex' has no property 'z'");
    CHECK(fault_in(folder, "a.ply",
                   "ply\nelement vertex 2\nproperty float x\nproperty float y\nproperty float "
                   "z\nend_header\n1 2 3\n") ==
          ":7: the file ends after 1 of 2 lines of element 'vertex'");
    CHECK(fault_in(folder, "a.ply", "ply\nelement face 0\nend_header\n") ==
          ": there is no element 'vertex' in it");
    CHECK(fault_in(folder, "a.csv", "x,y\n1,2\n") == ":1: the header has no column 'z'");
    CHECK(fault_in(folder, "a.csv", "x,y,z\n1,5,2,0,3,1\n") ==
          ":2: this line has 6 cells, the first one 3: write decimals with a point");
    CHECK(fault_in(folder, "a.csv", "1,5;2,0;3,1\n") ==
          ":1: this line has commas and semicolons: write decimals with a point");
    CHECK(fault_in(folder, "a.csv", "\xff\xfex\0y\0") ==
          ": the text is in UTF-16: save it in UTF-8");
    CHECK(fault_in(folder, "a.csv", "1,2,3\n1,2\n") == ":2: this point lacks a coordinate");
    CHECK(fault_in(folder, "a.csv", "1,2,3\n1,nan,2\n") == ":2: 'nan' is no number");
    CHECK(fault_in(folder, "a.csv", "# nothing\n") == ": there are no points in it");
    CHECK(fault_in(folder, "a.txt", "1 2 3\n") ==
          ": a curve is read from .obj, .ply or .csv, not from '.txt'");
    const auto absent = folder / "absent.csv";
    CHECK(failure_of([&] { read_curve(absent); }) == absent + " does not exist");
}

TEST_CASE("a curve is read from a regular file of a bounded size, and nothing keeps it waiting") {
    const Scratch folder;
    const auto refused = [](const std::string& path) {
        return failure_of([&] { read_curve(path); }).substr(path.size());
    };
    const auto pipe = folder / "pipe.csv";
    REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
    std::filesystem::create_symlink("/dev/zero", folder / "zero.obj");
    std::filesystem::create_directory(folder / "folder.ply");
    CHECK(refused(pipe) == " is a pipe or a device; a curve is read from a regular file");
    CHECK(NodeBench(rig_curve(), "{path: " + pipe + "}").survey({1}).absent.at(1) ==
          pipe + " is a pipe or a device; a curve is read from a regular file");
    CHECK(refused(folder / "zero.obj") ==
          " is a pipe or a device; a curve is read from a regular file");
    CHECK(refused(folder / "folder.ply") == " is a folder");
    const auto large = folder.write("large.csv", "");
    std::filesystem::resize_file(large, (std::uintmax_t{64} << 20) + 1);
    CHECK(refused(large) == " has 67108865 bytes; a curve has at most 64 MiB");
}

TEST_CASE("a curve that promises more than its file holds is refused where the file ends") {
    const Scratch folder;
    const auto counted = [&](const std::string& count) {
        return fault_in(
            folder, "a.ply",
            "ply\nformat ascii 1.0\nelement vertex " + count +
                "\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n");
    };
    CHECK(counted("1152921504606846976") ==
          ":8: the file ends after 1 of 1152921504606846976 lines of element 'vertex'");
    for (const std::string count : {"-1", "18446744073709551616", "1.5"})
        CHECK(counted(count) == ":3: an element needs a name and a count");
    CHECK(fault_in(folder, "a.obj", "v 0 0 0\nl 1 1152921504606846976\n") ==
          ":2: '1152921504606846976' is none of the 1 vertices above");
    CHECK(fault_in(folder, "a.obj", "v 0 0 0\nl 1 -9223372036854775808\n") ==
          ":2: '-9223372036854775808' is none of the 1 vertices above");
}

TEST_CASE(
    "rig.curve closes where its file does, unless told otherwise, and stands where it is put") {
    const Scratch folder;
    const auto loop = folder.write("loop.csv", "0,0,0\n1,0,0\n1,1,0\n0,0,0\n");
    const auto rig =
        made(NodeBench(rig_curve(), "{path: " + loop + ", translate: [10, 0, 0], scale: 2}"));
    CHECK(rig.closed);
    CHECK(rig.points == std::vector<Vec3d>{{10, 0, 0}, {12, 0, 0}, {12, 2, 0}});
    const auto open = made(NodeBench(rig_curve(), "{path: " + loop + ", closed: false}"));
    CHECK(!open.closed);
    CHECK(open.points.size() == 4);
    const auto line = folder.write("line.csv", "0,0,0\n1,0,0\n1,1,0\n");
    CHECK(!made(NodeBench(rig_curve(), "{path: " + line + "}")).closed);
    CHECK(made(NodeBench(rig_curve(), "{path: " + line + ", closed: true}")).points.size() == 3);
}

TEST_CASE(
    "rig.curve turns the axes of its file into those of the shot, before it scales and moves") {
    const Scratch folder;
    const auto line = folder.write("line.csv", "0,0,0\n1,2,3\n");
    const auto last = [&](const std::string& axes) {
        return made(NodeBench(rig_curve(), "{path: " + line + ", axes: " + axes +
                                               ", translate: [10, 0, 0], scale: 2}"))
            .points.at(1);
    };
    CHECK(last("as_is") == Vec3d(12, 4, 6));
    CHECK(last("y_to_z") == Vec3d(12, -6, 4));
    CHECK(last("z_to_y") == Vec3d(12, 6, -4));
    CHECK(made(NodeBench(rig_curve(), "{path: " + line + ", axes: y_to_z}")).up == Vec3d(0, 0, 1));

    const auto region =
        NodeBench(rig_curve(), "{path: " + line + ", axes: z_to_y}").survey({1}).regions.at("rig");
    REQUIRE(region.boxes.size() == 1);
    CHECK(to_text(region.boxes[0]) == to_text(Region::Box{{0, 0, -2}, {1, 3, 0}}));
    REQUIRE(region.otherwise.size() == 2);
    CHECK(region.otherwise[0].how == "`axes: as_is` in rig.curve");
    CHECK(to_text(around(region.otherwise[0].boxes)) == to_text(Region::Box{{0, 0, 0}, {1, 2, 3}}));
    CHECK(region.otherwise[1].how == "`axes: y_to_z` in rig.curve");
    CHECK(around(region.otherwise[1].boxes).low[1] == -3);
}

TEST_CASE("rigs say before a run where they will lie") {
    const auto circle =
        *NodeBench(rig_circle(), "{center: [0, 0, 2], radius: 5}").foresee().outputs;
    CHECK(circle.boxes.size() == 240);
    CHECK(around(circle.boxes).low[0] == Approx(-5));
    CHECK(around(circle.boxes).high[1] == Approx(5));
    CHECK(around(circle.boxes).high[2] == Approx(2));
    CHECK(!meet(circle.boxes, {{{-3, -3, 2}, {3, 3, 2}}}));
    const auto still =
        *NodeBench(rig_points(), "{points: [[0, 0, 0], [0, 4, 0], [1, 6, 0]]}").foresee().outputs;
    REQUIRE(still.boxes.size() == 2);
    CHECK(to_text(still.boxes[1]) == "(0, 4, 0) to (1, 6, 0)");
    const auto moving =
        *NodeBench(rig_points(), "{frames: {1: [[0, 0, 0], [0, 4, 0]], 9: [[5, 0, 0], [5, 4, 1]]}}")
             .foresee()
             .outputs;
    REQUIRE(moving.boxes.size() == 1);
    CHECK(to_text(moving.boxes[0]) == "(0, 0, 0) to (5, 4, 1)");
    CHECK(region_of(through({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, true)).boxes.size() == 3);

    const Region lines{{{{0, 0, 0}, {1, 1, 1}}, {{1, 1, 1}, {3, 1, 1}}},
                       {{"otherwise", {{{0, 0, 0}, {0, 0, 1}}}}}};
    const auto changed = [&](const std::string& yaml) {
        return *NodeBench(rig_transform(), yaml).foresee({{"rig", lines}}).outputs;
    };
    const auto moved = changed("{scale: 2, pivot: [1, 0, 0], translate: [0, 0, 1], extend: 0.5}");
    REQUIRE(moved.boxes.size() == 2);
    CHECK(to_text(moved.boxes[0]) == "(-1.5, -0.5, 0.5) to (1.5, 2.5, 3.5)");
    CHECK(to_text(moved.otherwise.at(0).boxes.at(0)) == "(-1.5, -0.5, 0.5) to (-0.5, 0.5, 3.5)");
    const auto smooth = changed("{smooth: 1}");
    REQUIRE(smooth.boxes.size() == 1);
    CHECK(to_text(smooth.boxes[0]) == "(0, 0, 0) to (3, 1, 1)");
    CHECK(!NodeBench(rig_transform(), "{smooth: 1}").foresee().outputs);
}

TEST_CASE(
    "rig.curve with a frame token reads a file per frame, and says before a run which of them are "
    "no good") {
    const Scratch folder;
    folder.write("c.0003.csv", "0,0,0\n3,0,0\n");
    folder.write("c.0004.csv", "0,0,0\n0,0,0\n");
    const auto path = folder / "c.####.csv";
    NodeBench bench(rig_curve(), "{path: \"" + path + "\"}");
    CHECK(made(NodeBench(rig_curve(), "{path: \"" + path + "\"}"), 3).points[1] == Vec3d(3, 0, 0));
    const auto surveyed = bench.survey({3, 4, 5});
    REQUIRE(surveyed.absent.size() == 2);
    CHECK(surveyed.absent.at(4) ==
          (folder / "c.0004.csv") + ": points 1 and 2 of the rig are the same, (0, 0, 0)");
    CHECK(surveyed.absent.at(5) == (folder / "c.0005.csv") + " does not exist");
    CHECK(NodeBench(rig_curve(), "{path: " + (folder / "c.0009.csv") + "}")
              .survey({3, 4})
              .absent.at(3) == (folder / "c.0009.csv") + " does not exist");
}

TEST_CASE(
    "rig.transform smooths, scales about its pivot, moves and extends, and a circle stays one "
    "unless it is smoothed") {
    const auto line = std::make_shared<Rig>(through({{0, 0, 0}, {3, 3, 0}, {6, 0, 0}}));
    const auto run = [](const std::string& yaml, const std::shared_ptr<Rig>& rig) {
        return *NodeBench(rig_transform(), yaml).run({{"rig", {Payload(rig)}}}).at("rig").as<Rig>();
    };
    CHECK(run("{smooth: 1}", line).points == std::vector<Vec3d>{{0, 0, 0}, {3, 1, 0}, {6, 0, 0}});
    CHECK(run("{scale: 2, pivot: [6, 0, 0], translate: [0, 0, 1]}", line).points ==
          std::vector<Vec3d>{{-6, 0, 1}, {0, 6, 1}, {6, 0, 1}});

    // Scaled to twice its size, then extended by what was said.
    CHECK((run("{scale: 2, extend: 1}", line).points[0] + Vec3d(1, 1, 0).unit()).length() < 1e-12);
    CHECK(run("{extend: 5}", std::make_shared<Rig>(through({{0, 0, 0}, {0, 3, 0}, {2, 3, 0}})))
              .points ==
          std::vector<Vec3d>{{0, -5, 0}, {0, 0, 0}, {0, 3, 0}, {2, 3, 0}, {7, 3, 0}});

    const auto circle =
        std::make_shared<Rig>(circle_rig(Vec3d(1, 0, 0), Vec3d(0, 0, 1), {2, 2}, 0));
    CHECK(failure_of([&] { run("{extend: 1}", circle); }) ==
          "a circle of radius 2 around (1, 0, 0) is closed: it has no ends to 'extend'");
    const auto larger = run("{scale: 3, translate: [0, 5, 0]}", circle);
    REQUIRE(larger.oval);
    CHECK(to_text(larger) == "a circle of radius 6 around (3, 5, 0)");
    CHECK((larger.oval->at(0.7) - (3.0 * circle->oval->at(0.7) + Vec3d(0, 5, 0))).length() < 1e-12);
    const auto round = run("{smooth: 2}", circle);
    CHECK(!round.oval);
    CHECK((round.points[5] - Vec3d(1, 0, 0)).length() < 2);
}

TEST_CASE("points in a ball are spread evenly, the same each time, their middle in its middle") {
    const Vec3d center(1, -2, 3);
    const auto points = points_in_ball(center, 2, 500);
    REQUIRE(points.size() == 500);
    Vec3d sum(0);
    int inner = 0;
    for (const auto& point : points) {
        sum += point;
        CHECK((point - center).length() < 2.1);
        inner += (point - center).length() < 1 ? 1 : 0;
    }
    CHECK((sum / 500.0 - center).length() < 1e-12);
    CHECK(inner == Approx(500.0 / 8).margin(15));
    CHECK(points == points_in_ball(center, 2, 500));
}

TEST_CASE(
    "rig.advect in a uniform flow is the straight line from the seed on, whatever frames are left "
    "out") {
    const auto flow = sampled<VectorGrid>(CoordBBox(Coord(-8), Coord(40)), 0.25,
                                          [](const Vec3d&) { return openvdb::Vec3s(2, 0, 1); });
    const std::string yaml = "{seed: [0, 1, 2], radius: 0.5, scale: 0.25}";
    const auto rig = advected(yaml, flow, {1, 2, 3, 4});
    REQUIRE(rig.points.size() == 5);
    CHECK(rig.points[0] == Vec3d(0, 1, 2));
    for (std::size_t n = 1; n <= 4; ++n)
        CHECK((rig.points[n] - (Vec3d(0, 1, 2) + n * 0.25 * Vec3d(2, 0, 1))).length() < 1e-6);
    CHECK(!rig.closed);

    const auto sparse = advected(yaml, flow, {1, 3, 5});
    REQUIRE(sparse.points.size() == 4);
    CHECK((sparse.points[1] - Vec3d(1, 1, 2.5)).length() < 1e-6);
    CHECK((sparse.points[3] - Vec3d(3, 1, 3.5)).length() < 1e-6);
}

TEST_CASE(
    "rig.advect in a rotation runs along its circle, on centred and on staggered velocities") {
    const double voxel = 0.1, turn = 0.1;
    const auto velocity = [](const Vec3d& at) { return rotation({0, 0, 1}, at); };
    const CoordBBox box(Coord(-30, -30, -5), Coord(30, 30, 5));
    const std::vector<int> frames{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    for (const auto& flow :
         {sampled<VectorGrid>(box, voxel, velocity), sampled_staggered(box, voxel, velocity)}) {
        const auto rig =
            advected("{seed: [2, 0, 0], radius: 0.2, count: 100, scale: 0.1}", flow, frames);
        REQUIRE(rig.points.size() == frames.size() + 1);
        for (std::size_t n = 0; n < rig.points.size(); ++n) {
            const double angle = turn * static_cast<double>(n);
            CHECK((rig.points[n] - Vec3d(2 * std::cos(angle), 2 * std::sin(angle), 0)).length() <
                  0.01 * voxel);
        }
    }
}

TEST_CASE("rig.advect leaves out middles that hardly moved, and refuses if none did") {
    const auto flow = [](const openvdb::Vec3s& velocity) {
        return sampled<VectorGrid>(CoordBBox(Coord(-8), Coord(40)), 0.25,
                                   [=](const Vec3d&) { return velocity; });
    };
    CHECK(advected("{seed: [0, 0, 0], radius: 0, count: 1, scale: 0.13}", flow({1, 0, 0}),
                   {1, 2, 3, 4, 5})
              .points.size() == 3);
    CHECK(advected("{seed: [0, 0, 0], radius: 0, count: 1, scale: 0.13, apart: 0}", flow({1, 0, 0}),
                   {1, 2, 3, 4, 5})
              .points.size() == 6);
    CHECK(failure_of([&] {
              advected("{seed: [0, 0, 9], radius: 1}", flow({0, 0, 0}), {1, 2, 3});
          }) ==
          "the points stay within 0.25 of the seed, (0, 0, 9): the velocity there is too small, or "
          "'scale' is");
    CHECK(failure_of([&] {
              advected("{seed: [0, 0, 0], radius: 0}", flow({NAN, 0, 0}), {1, 2});
          }) == "grid 'sampled' has a value that is not finite near (0, 0, 0)");
    CHECK(NodeBench(rig_advect(), "{seed: [0, 0, 0], radius: 0, scale: 0}").faults() ==
          "scale: 'scale' must be more than 0\n");
}

TEST_CASE("rig.advect goes by the points that are in the flow, and ends where it ends") {
    // A channel along x, from -1 to 4, that fills y below 0 only.
    const auto channel = sampled<VectorGrid>(CoordBBox(Coord(-4, -16, -8), Coord(16, -1, 8)), 0.25,
                                             [](const Vec3d&) { return openvdb::Vec3s(1, 0, 0); });
    const auto half =
        advected("{seed: [0, 0, 0], radius: 0.5, count: 500, scale: 1.5}", channel, {1, 2});
    REQUIRE(half.points.size() == 3);
    CHECK(half.points[0] == Vec3d(0));
    // What is left of the ball: the cap below the last voxels' edge, whose middle is a quarter of a
    // unit down. By the edge the flow is slower.
    CHECK(half.points[1].y() == Approx(-0.25).margin(0.02));
    CHECK(half.points[1].x() == Approx(1.4).margin(0.15));
    const auto whole =
        advected("{seed: [0, -2, 0], radius: 0.5, count: 500, scale: 1.5}", channel, {1, 2, 3, 4});
    REQUIRE(whole.points.size() == 4);
    CHECK((whole.points[2] - Vec3d(3, -2, 0)).length() < 1e-6);
    CHECK(whole.points[3].x() == Approx(4).margin(0.13));
    CHECK(failure_of([&] {
              advected("{seed: [0, 2, 0], radius: 0.5}", channel, {1, 2});
          }) ==
          "no point around the seed, (0, 2, 0), stays where the velocity is active: move 'seed' "
          "into the flow, or take a smaller 'scale'");
    CHECK(failure_of([&] {
              advected("{seed: [0, -1, 0], radius: 0.5, scale: 20}", channel, {1, 2});
          }).starts_with("no point around the seed, (0, -1, 0)"));
}
