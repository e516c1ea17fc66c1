#include "formats/points_file/ply.h"
#include "carve/stream/openvdb_types.h"
#include "formats/points_file/points_file.h"
#include "nodes/points.h"
#include "tests/support/files/point_files.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/node_bench.h"
#include "tests/support/point_lists.h"
#include "tests/support/scratch.h"

#include <fmt/format.h>
#include <openvdb/points/PointDataGrid.h>
#include <catch2/catch.hpp>

#include <sys/stat.h>
#include <algorithm>
#include <cmath>
#include <filesystem>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Vec3d;

TEST_CASE("PLY files are read in all their encodings, and written as they were") {
    const Scratch scratch;
    const auto points = read(scratch.write("a.ply", typical_ascii));
    REQUIRE(points.size() == 3);
    CHECK(points.positions()[0] == Vec3d(0.1f, -2.5, 1e-20f));
    const auto number = [&](const char* name, std::size_t n) {
        return PointTable::number(*points.ply->column(name), n);
    };
    CHECK(number("red", 0) == 255);
    CHECK(number("age", 0) == 0.30000000000000004);
    CHECK(number("age", 1) == 1e300);
    CHECK(number("kind", 0) == -7);
    CHECK(number("key", 0) == 4294967295.0);
    CHECK(number("sign", 0) == -1);
    CHECK(std::isinf(number("v_z", 1)));
    CHECK(std::isnan(number("v_x", 2)));
    CHECK(std::signbit(number("age", 2)));

    write_points(scratch / "b.ply", points, nullptr, nullptr, nullptr);
    CHECK(Scratch::read(scratch / "b.ply") == typical_ascii);
    for (const auto encoding : {NumberForm::little, NumberForm::big}) {
        write_points(scratch / "c.ply", points, nullptr, &encoding, nullptr);
        const auto bytes = Scratch::read(scratch / "c.ply");
        const auto header = fmt::format(fmt::runtime(typical_header), encoding == NumberForm::little
                                                                          ? "binary_little_endian"
                                                                          : "binary_big_endian");
        REQUIRE(bytes.substr(0, header.size()) == header);
        REQUIRE(bytes.size() == header.size() + 3 * (3 * 4 + 1 + 8 + 2 + 4 + 1 + 3 * 4));
        // -2.5 and -7, by hand.
        CHECK(bytes.substr(header.size() + 4, 4) == (encoding == NumberForm::little
                                                         ? std::string("\0\0\x20\xc0", 4)
                                                         : std::string("\xc0\x20\0\0", 4)));
        CHECK(bytes.substr(header.size() + 21, 2) ==
              (encoding == NumberForm::little ? "\xf9\xff" : "\xff\xf9"));
        const auto again = read(scratch / "c.ply");
        CHECK(sorted_rows(*again.ply) == sorted_rows(*points.ply));
        write_points(scratch / "d.ply", again, nullptr, nullptr, nullptr);
        CHECK(Scratch::read(scratch / "d.ply") == bytes);
    }
}

TEST_CASE("a PLY file of another system's line ends, or with vertices on one line, is read") {
    const Scratch scratch;
    const std::string header =
        "ply\r\nformat ascii 1.0\r\nelement vertex 2\r\nproperty float x\r\nproperty float "
        "y\r\nproperty float z\r\nend_header\r\n";
    CHECK(read(scratch.write("a.ply", header + "1 2 3\r\n4 5 6")).positions() ==
          std::vector{Vec3d(1, 2, 3), Vec3d(4, 5, 6)});
    CHECK(read(scratch.write("b.ply", header + "1 2 3 4 5 +6\r\n")).positions() ==
          std::vector{Vec3d(1, 2, 3), Vec3d(4, 5, 6)});
}

TEST_CASE(
    "a placement moves PLY points into the shot's world, and the writer takes it back to the last "
    "bit") {
    const Scratch scratch;
    const auto path = scratch.write("a.ply", typical_ascii);
    const auto points = read_points(path, "", PointOffset::detect, {Vec3d(10, 20, 30), 2});
    CHECK(points.positions()[1] == Vec3d(13, 20, 36));
    write_points(scratch / "b.ply", points, nullptr, nullptr, nullptr);
    CHECK(Scratch::read(scratch / "b.ply") == typical_ascii);
    const Placement none;
    write_points(scratch / "c.ply", points, nullptr, nullptr, &none);
    CHECK(read(scratch / "c.ply").positions()[1] == Vec3d(13, 20, 36));
}

TEST_CASE("points go from VDB to PLY and back with all that PLY can hold") {
    const Scratch scratch;
    const auto points = read(river_43);
    CHECK(write_points(scratch / "a.ply", points, nullptr, nullptr, nullptr).attributes.empty());
    const auto ply = read(scratch / "a.ply");
    std::string names;
    for (const auto& column : ply.ply->columns) names += column.type_name + ' ' + column.name + ' ';
    CHECK(names ==
          "double x double y double z int U float particles_velocity_x float particles_velocity_y "
          "float particles_velocity_z ");
    CHECK(ply.positions() == points.positions());
    const Placement placement{Vec3d(1, -2, 3), 2};
    const auto moved = read_points(river_43, "", PointOffset::detect, placement);
    write_points(scratch / "moved.ply", moved, nullptr, nullptr, nullptr);
    CHECK(Scratch::read(scratch / "moved.ply") == Scratch::read(scratch / "a.ply"));
    const auto there = read_points(scratch / "moved.ply", "", PointOffset::detect, placement)
                           .positions(),
               wanted = moved.positions();
    double worst = 0;
    for (std::size_t n = 0; n < wanted.size(); ++n)
        worst = std::max(worst, (there[n] - wanted[n]).length());
    CHECK(worst < 1e-12);

    write_points(scratch / "b.vdb", ply, nullptr, nullptr, nullptr);
    const auto back = read(scratch / "b.vdb");
    write_points(scratch / "c.ply", back, nullptr, nullptr, nullptr);
    auto first = *ply.ply, second = *read(scratch / "c.ply").ply;
    REQUIRE(first.size == second.size);
    // Positions are floats within their voxel again, in another order; all else is as it was.
    for (auto* const each : {&first, &second})
        each->columns.erase(each->columns.begin(), each->columns.begin() + 3);
    CHECK(sorted_rows(first) == sorted_rows(second));
    std::vector<double> a, b;
    for (const auto& at : ply.positions()) a.push_back(at.x());
    for (const auto& at : back.positions()) b.push_back(at.x());
    std::ranges::sort(a);
    std::ranges::sort(b);
    for (std::size_t n = 0; n < a.size(); ++n) REQUIRE(a[n] == Approx(b[n]).margin(1e-7));
}

TEST_CASE("what PLY can't hold is said") {
    const Scratch scratch;
    Told told;
    const std::vector<int> frames{1};
    auto ply = ply_at({Vec3d(1, 2, 3)});
    ply.columns.push_back(column<std::uint32_t>("key", "uint", NumberType::uint32, {4000000000u}));
    const auto points = std::make_shared<Points>();
    points->grid = grid_of(ply);
    NodeBench writer(points_write(), "{path: " + (scratch / "a.ply") + "}");
    writer.run({{"source", {Payload(points)}}}, Context(told, frames).at(0));
    CHECK(told.warnings ==
          std::vector<std::string>{"attribute 'key' is of a type that PLY can't hold and is left "
                                   "out; write a .vdb to keep it"});
    CHECK(read(scratch / "a.ply").ply->column("id"));
    CHECK_FALSE(read(scratch / "a.ply").ply->column("key"));

    const auto houdini = read(data + "/vdb/cortex_points.vdb");
    write_points(scratch / "b.ply", houdini, nullptr, nullptr, nullptr);
    CHECK(read(scratch / "b.ply").size() == houdini.size());
}

TEST_CASE("a PLY file that is damaged is refused with the reason") {
    const Scratch scratch;
    const auto refused = [&](const std::string& text) {
        return refusal(scratch.write("a.ply", text));
    };
    const auto with = [](std::string text, const std::string& was, const std::string& now) {
        return text.replace(text.find(was), was.size(), now);
    };
    const std::string small =
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty "
        "float z\nend_header\n1 2 3\n";
    REQUIRE(refused(small) == "");

    CHECK(refused(small.substr(0, 30)) ==
          "FILE is cut off: it ends within its header; copy or write it again");
    CHECK(refused(with(small, "vertex 1", "vertex 4000000000")) ==
          "FILE is cut off: it states 4000000000 vertices of 6 or more bytes, but has 6 bytes "
          "after its header; copy or write it again");
    CHECK(refused(with(small, "vertex 1", "vertex 99999999999999999999")) ==
          "FILE is damaged: its header counts '99999999999999999999' of an element");
    CHECK(refused(with(small, "vertex 1", "vertex -1")) ==
          "FILE is damaged: its header counts '-1' of an element");
    CHECK(refused(with(small, "1 2 3", "1 2 nan")) ==
          "FILE is damaged: the position of vertex 0 is not finite");
    CHECK(refused(with(small, "1 2 3", "1 2 1e39")) ==
          "FILE is damaged: vertex 0 has '1e39' as z, a float");
    CHECK(refused(with(small, "1 2 3", "1 2 3 4")) ==
          "FILE is damaged: it goes on after the 1 vertices that it states");
    CHECK(refused(with(small, "1 2 3", "100 2")) ==
          "FILE is cut off: it states 1 vertices and ends in vertex 0; copy or write it again");
    CHECK(refused(with(small, "1 2 3", "1 2 {3}")) ==
          "FILE is damaged: vertex 0 has '?3?' as z, a float");
    CHECK(refused(with(small, "ascii", "binary_middle_endian")) ==
          "FILE has the format 'binary_middle_endian 1.0', which is not one of PLY 1.0");
    CHECK(refused(with(small, "float z", "float \xff\xfe")) ==
          "FILE is damaged: vertex property 3 has a name that is not plain text");
    CHECK(refused(with(small, "float z", "quad z")) ==
          "FILE is damaged: vertex property 3 is of the type 'quad', which PLY does not have");
    CHECK(refused(with(small, "float z", "float y")) ==
          "FILE is damaged: it has two vertex properties 'y'");
    CHECK(refused(with(small, "float z", "int z")) ==
          "FILE has no vertex property 'z' of type float or double");
    CHECK(refused(with(small, "float z", "list uchar int z")) ==
          "FILE has the list 'z' at its vertices, which points can't hold; save it without");
    CHECK(refused(with(small, "end_header", "element face 2\nend_header")) ==
          "FILE has elements 'face', which would lose their vertices: read it by mesh.read, or "
          "save its points alone");
    CHECK(refused(with(small, "element vertex 1", "elephant")) ==
          "FILE is damaged: its header has the line 'elephant'");
    CHECK(refused(with(small, "element vertex 1\n", "")) ==
          "FILE is damaged: a property stands before the first element");
    CHECK(refused(with(small, "format ascii 1.0\n", "")) ==
          "FILE is damaged: its header does not say which format it has");
    CHECK(refused("ply\n" + std::string(2 << 20, 'x')) ==
          "FILE is damaged: its header is longer than 1048576 bytes");
    CHECK(refused("plywood, no points") == "FILE is not a VDB file");
    CHECK(refused("") ==
          "FILE is cut off: it ends within its header, at byte 0; copy or write it again");
    CHECK(refusal(scratch / "none.ply") == "FILE does not exist");

    const std::string binary = with(small, "ascii", "binary_big_endian");
    const auto header = binary.substr(0, binary.find("1 2 3"));
    CHECK(refused(header + std::string(12, '\0')) == "");
    CHECK(refused(header + std::string(11, '\0')) ==
          "FILE is cut off: it states 1 vertices of 12 or more bytes, but has 11 bytes after its "
          "header; copy or write it again");
    CHECK(refused(header + std::string(13, '\0')) ==
          "FILE is damaged: it goes on after the 1 vertices that it states");
    CHECK(refused(header + std::string(8, '\0') + "\x7f\x80" + std::string(2, '\0')) ==
          "FILE is damaged: the position of vertex 0 is not finite");
}

TEST_CASE("a PLY header of points may be long, and is read again as a whole") {
    const Scratch scratch;
    std::string text = "ply\nformat binary_little_endian 1.0\n";
    for (int n = 0; n < 5000; ++n) text += "comment of no use\n";
    text += "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n" +
            std::string(12, '\0');
    const auto points = read(scratch.write("a.ply", text));
    CHECK(points.positions() == std::vector{Vec3d(0)});
    CHECK(points.ply->comments.size() == 5000);
    CHECK(points.ply->columns.size() == 3);
}

TEST_CASE("points in bytes are read whole, however many pieces they take") {
    const Scratch scratch;
    std::vector<Vec3d> all;
    for (int n = 0; n < 100000; ++n) all.emplace_back(n, -n, 0.5 * n);
    auto ply = ply_at(all);
    for (const auto encoding : {NumberForm::little, NumberForm::big}) {
        ply.encoding = encoding;
        write_ply(scratch / "a.ply", ply);
        CHECK((read(scratch / "a.ply").positions() == all));
    }
}

TEST_CASE("counts beyond a file of points are refused before anything is allocated for them") {
    const Scratch scratch;
    for (const std::string format : {"ascii", "binary_little_endian"}) {
        const auto refused = [&](const std::string& count) {
            return refusal(scratch.write("a.ply", "ply\nformat " + format +
                                                      " 1.0\nelement vertex " + count +
                                                      "\nproperty double x\nproperty double "
                                                      "y\nproperty double z\nend_header\n1 2 3\n"));
        };
        CHECK(refused("1152921504606846976") ==
              "FILE is damaged: it states 1152921504606846976 vertices; the most is 4294967295");
        CHECK_THAT(refused("4294967295"),
                   Catch::StartsWith("FILE is cut off: it states 4294967295 vertices"));
        CHECK(refused("-1152921504606846976") ==
              "FILE is damaged: its header counts '-1152921504606846976' of an element");
    }
}

TEST_CASE("points are read from a regular file, and nothing keeps them waiting") {
    const Scratch scratch;
    const auto pipe = scratch / "pipe.ply";
    REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
    std::filesystem::create_symlink("/dev/zero", scratch / "zero.ply");
    for (const auto& path : {pipe, scratch / "zero.ply"}) {
        CHECK(refusal(path) ==
              "FILE is a pipe or a device; a file of points is read from a regular file");
        CHECK(failure_of([&] { probe_points(path, ""); }) ==
              path + " is a pipe or a device; a file of points is read from a regular file");
    }
    CHECK(refusal(scratch.path()) == "FILE is not a file");
}
