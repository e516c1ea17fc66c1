#include "formats/mesh_file/mesh_file.h"

#include "carve/base/failure.h"
#include "carve/mesh/triangles.h"
#include "formats/mesh_file/topology.h"
#include "nodes/mesh.h"
#include "tests/support/files/mesh_files.h"
#include "tests/support/node_bench.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

#include <sys/stat.h>

#include <filesystem>

using namespace fluidcarve;
using namespace fluidcarve::test;
using Attribute = Mesh::Attribute;

namespace {

std::string fault_of(const Scratch& scratch, const std::string& name, const std::string& text) {
    try {
        read_mesh(scratch.write(name, text));
    } catch (const Failure& failure) {
        CHECK(failure.kind == Failure::Kind::input);
        const std::string message = failure.what();
        CHECK(message.starts_with(scratch / name + ":"));
        return message.substr((scratch / name).size() + 1);
    }
    return "none";
}

}  // namespace

TEST_CASE("malformed OBJ files are refused with line and reason") {
    const Scratch scratch;
    const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    const auto fault = [&](const std::string& text) { return fault_of(scratch, "a.obj", text); };
    CHECK(fault("") == " the file is empty");
    CHECK(fault("\n\n# nothing\n") == " this is no OBJ file: there is no statement in it");
    CHECK(fault("v 0 0\n") == "1: a vertex needs three numbers");
    CHECK(fault("v 0 nan 0\n") == "1: 'nan' is no number");
    CHECK(fault("v 0 1e999 0\n") == "1: '1e999' is no number");
    CHECK(fault("v 0 \xff\xfe 0\n") == "1: '?\?' is no number");
    CHECK(fault("v 1 2 3 4 5 6 7 8\n") == "1: these are more than 7 numbers");
    CHECK(fault("v 1 2 3\nv 1 2 3 4\n") ==
          "2: there are not as many numbers as in the statements before of its kind");
    CHECK(fault(three + "f 1 2\n") == "4: a face needs at least three corners");
    CHECK(fault(three + "f 0 1 2\n") == "4: '0' is none of the 3 above");
    CHECK(fault(three + "f -1 -2 -4\n") == "4: '-4' is none of the 3 above");
    CHECK(fault(three + "f 1 2 4\n") == " face 1 has vertex 4, but there are 3 vertices");
    CHECK(fault(three + "f 1 2 99999999999\n") == "4: '99999999999' is none of the 3 above");
    CHECK(fault(three + "vt 0 0\nf 1/1 2/1 3/2\n") == " face 1 has uv 2, but there are 1 uvs");
    CHECK(fault(three + "f 1//1 2//1 3//1\n") == " face 1 has normal 1, but there are 0 normals");
    CHECK(fault(three + "f 1/1/1/1 2 3\n") == "4: a corner has at most three indices, as in 1/2/3");
    CHECK(fault(three + "l 1 -1\n") ==
          "4: '-1' counts back from the last vertex, which can't be kept in lines and points");
    CHECK(fault(three + "vt 0 0\nl 1/-1 2/-1\n") ==
          "5: '-1' counts back from the last UV, which can't be kept in lines");
    CHECK(fault(three + "f 1 2 \\\n3\n") ==
          "4: a statement that is continued in the next line, by a '\\' at the end, can't be read; "
          "join the lines");
    CHECK(fault("\x89PNG\n") ==
          "1: '?PNG' is no statement that can be kept: a mesh is made of v, vt, vn, f, l and p");
    CHECK_THROWS_WITH(read_mesh(scratch / "none.obj"), scratch / "none.obj" + " does not exist");
    CHECK_THROWS_WITH(read_mesh(scratch.path()),
                      scratch.path() + ": a mesh is a .obj, .ply, .off or .stl file, not ''");
}

TEST_CASE("malformed PLY files are refused before anything is allocated for what they promise") {
    const Scratch scratch;
    const auto fault = [&](const std::string& text) { return fault_of(scratch, "a.ply", text); };
    const auto head = [](const std::string& format, const std::string& vertices,
                         const std::string& list = "uchar") {
        return "ply\nformat " + format + " 1.0\nelement vertex " + vertices +
               "\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty "
               "list " +
               list + " int vertex_indices\nend_header\n";
    };
    const std::string three = "0 0 0\n1 0 0\n0 1 0\n";
    CHECK(fault("") == " the file is empty");
    CHECK(fault("plx\n") == "1: this is no PLY file: its first line is not 'ply'");
    CHECK(fault("ply\nformat ascii 1.0\n") == "2: the header has no 'end_header'");
    CHECK(fault("ply\nformat binary 1.0\n") == "2: 'binary' is no format of PLY");
    CHECK(fault("ply\nend_header\n") == "2: the header states no format");
    CHECK(fault("ply\nformat ascii 1.0\nend_header\n") ==
          " a mesh has one element 'vertex' and at most one 'face'");
    CHECK(fault(head("ascii", "-3")) == "3: '-3' is no count");
    CHECK(fault(head("ascii", "18446744073709551615")) ==
          "3: '18446744073709551615' is no whole number");
    for (const auto* const format : {"ascii", "binary_little_endian"})
        CHECK(fault(head(format, "4000000000")) ==
              " the header promises 4000000000 entries of 'vertex', for which the file is too "
              "short: it is cut off or damaged");
    CHECK(fault(head("ascii", "3") + three + "3 0 1") == "13: the file ends too early");
    CHECK(fault(head("ascii", "3") + three + "3 0 1 3\n") ==
          " face 0 has a vertex 3, but there are 3 (both counted from 0)");
    CHECK(fault(head("ascii", "3") + three + "3 0 1 -1\n") ==
          " face 0 (counted from 0) has a vertex -1");
    CHECK(fault(head("ascii", "3") + three + "2 0 1 1\n") ==
          " face 0 (counted from 0) has 2 corners; it needs at least three");
    CHECK(fault(head("ascii", "3") + "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n") ==
          "11: 'nan' is no number");
    CHECK(
        fault(head("binary_little_endian", "0", "uint") + "\xff\xff\xff\xff" +
              std::string(8, '\0')) ==
        " a list 'vertex_indices' of 4294967295 entries can't be: the file is cut off or damaged");
    CHECK(fault(head("binary_little_endian", "0", "char") + "\xff" + std::string(8, '\0')) ==
          " a list 'vertex_indices' of -1 entries can't be: the file is cut off or damaged");
    CHECK(fault(head("ascii", "3", "float") + three + "3 0 1 2\n") ==
          "8: a list is counted in whole numbers");
    CHECK(fault(head("binary_little_endian", "1") + bytes(0.0f) +
                bytes(std::numeric_limits<float>::quiet_NaN()) + bytes(0.0f) + '\3' +
                std::string(12, '\0')) ==
          " vertex 0 (counted from 0) is not at a finite place: its y is nan");
    auto whole = ply_of("binary_little_endian", false);
    for (const std::size_t less : {1, 2, 13, 30})
        CHECK(fault(whole.substr(0, whole.size() - less)).find("cut off or damaged") !=
              std::string::npos);
}

TEST_CASE(
    "counts and lengths beyond a mesh's file are refused before anything is allocated for them") {
    const Scratch scratch;
    const std::string huge = "1152921504606846976",
                      axes = "property float x\nproperty float y\nproperty float z\n";
    for (const std::string format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
        INFO(format);
        const auto fault = [&](const std::string& vertices, const std::string& faces,
                               const std::string& data) {
            return fault_of(scratch, "a.ply",
                            "ply\nformat " + format + " 1.0\nelement vertex " + vertices + "\n" +
                                axes + "element face " + faces +
                                "\nproperty list int int vertex_indices\nend_header\n" + data);
        };
        const std::string few(100, ' ');
        CHECK(
            fault(huge, "0", few) ==
            " the header promises " + huge +
                " entries of 'vertex', for which the file is too short: it is cut off or damaged");
        CHECK(fault("0", huge, few) ==
              " the header promises " + huge +
                  " entries of 'face', for which the file is too short: it is cut off or damaged");
        CHECK(fault("-1", "0", few) == "3: '-1' is no count");
        CHECK(fault("1", "-" + huge, few) == "7: '-" + huge + "' is no count");
        const bool ascii = format == "ascii", big = format == "binary_big_endian";
        for (const std::int32_t length : {2147483647, -2147483647})
            CHECK_THAT(fault("0", "1", (ascii ? std::to_string(length) : bytes(length, big)) + few),
                       Catch::Contains("entries can't be: the file is cut off or damaged"));
    }
    CHECK_THAT(fault_of(scratch, "a.off", "OFF\n" + huge + " 0 0\n"),
               Catch::Contains("for which the file is too short"));
    CHECK_THAT(fault_of(scratch, "a.off", "OFF\n0 " + huge + " 0\n"),
               Catch::Contains("for which the file is too short"));
    CHECK(fault_of(scratch, "a.off", "OFF\n-3 1 0\n") == "2: '-3' is no count");
    CHECK_THAT(fault_of(scratch, "a.off", "OFF\n1 1 0\n0 0 0\n" + huge + " 0 0 0\n"),
               Catch::Contains("has only 3 numbers behind the count"));
    CHECK(fault_of(scratch, "a.obj", "v 0 0 0\nf 1 1 " + huge + "\n") ==
          "2: '" + huge + "' is none of the 1 above");
    CHECK(fault_of(scratch, "a.obj", "v 0 0 0\nf 1 1 -9223372036854775808\n") ==
          "2: '-9223372036854775808' is none of the 1 above");
}

TEST_CASE("a mesh is read from a regular file, and nothing keeps it waiting") {
    const Scratch scratch;
    std::filesystem::create_symlink("/dev/zero", scratch / "zero.ply");
    std::filesystem::create_directory(scratch / "folder.ply");
    const auto pipe = scratch / "pipe.ply";
    REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
    for (const auto& path : {pipe, scratch / "zero.ply"}) {
        CHECK_THROWS_WITH(read_mesh(path),
                          path + " is a pipe or a device; a mesh is read from a regular file");
        CHECK_THROWS_WITH(probe_mesh(path),
                          path + " is a pipe or a device; a mesh is read from a regular file");
    }
    CHECK_THROWS_WITH(read_mesh(scratch / "folder.ply"), scratch / "folder.ply" + " is a folder");
}

TEST_CASE("malformed OFF and STL files are refused") {
    const Scratch scratch;
    const auto off = [&](const std::string& text) { return fault_of(scratch, "a.off", text); };
    CHECK(off("ply\n") ==
          "1: this is no OFF file of three-dimensional points: it begins with 'ply'");
    CHECK(off("4OFF\n1 0 0\n") ==
          "1: this is no OFF file of three-dimensional points: it begins with '4OFF'");
    CHECK(off("OFF BINARY\n") == "1: binary OFF can't be read; export it as text");
    CHECK(off("OFF\n99999999 1 0\n") ==
          " the head promises 99999999 vertices and 1 faces, for which the file is too short: it "
          "is cut off or damaged");
    CHECK(off("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1\n3 0 1 2\n") ==
          "5: a vertex of this file does not have 2 numbers");
    CHECK(off("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n") ==
          "6: a face has a vertex 3, but there are 3, counted from 0");
    CHECK(off("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n") ==
          "6: a face has a vertex -1, but there are 3, counted from 0");
    CHECK(off("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n") ==
          "6: a face of 4 corners has only 3 numbers behind the count");
    CHECK(off("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 inf\n3 0 1 2\n") == "5: 'inf' is no number");
    CHECK(off("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0 # cut\n") == "5: the file ends too early");

    const auto stl = [&](const std::string& text) { return fault_of(scratch, "a.stl", text); };
    CHECK(stl("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n") ==
          "4: the file ends too early");
    CHECK(stl("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 x\n") == "4: 'x' is no number");
    CHECK(stl("solid a\nvertex 0 0 0\n") ==
          "2: 'facet' or 'endsolid' should stand here, not 'vertex'");
    CHECK(stl("solid a\n") == "1: the file ends without 'endsolid': it is cut off");
    CHECK(stl("xx") ==
          " this is no STL file: it neither begins with 'solid' nor has the head of a binary one");
    CHECK(stl(std::string(80, 'x') + "\xff\xff\xff\xff" + std::string(50, '\0')) ==
          " the head promises 4294967295 triangles, for which the file is too short: it is cut "
          "off, damaged, or no STL file");
    const auto nan = bytes(std::numeric_limits<float>::quiet_NaN());
    CHECK(stl(std::string(80, 'x') + bytes(std::uint32_t{1}) + std::string(12, '\0') + nan +
              std::string(34, '\0')) ==
          " triangle 0 (counted from 0) has a corner that is not at a finite place");
}
