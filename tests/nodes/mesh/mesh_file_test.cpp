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

#include <array>
#include <filesystem>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Vec3d;
using Attribute = Mesh::Attribute;

namespace {

/// A quad and a triangle that share an edge, with UVs per corner, of which the edge's differ on its
/// sides, normals, a group and materials; one vertex has no face.
const std::string small_obj =
    "# made by hand\n"
    "mtllib bank.mtl\n"
    "o bank\n"
    "v 0.1 0.2 0.30000000000000004\n"
    "v 1 0 1e-05\n"
    "v 1.5 1 0\n"
    "v 0 1 0\n"
    "v 2.5 0.5 -0.123456789012345\n"
    "v 7 8 9\n"
    "vt 0 0\n"
    "vt 0.5 0\n"
    "vt 0.5 1\n"
    "vt 0 1\n"
    "vt 0.6 0\n"
    "vn 0 0 1\n"
    "vn 0 0.6 0.8\n"
    "g shore\n"
    "usemtl sand\n"
    "s off\n"
    "f 1/1/1 2/2/1 3/3/1 4/4/1\n"
    "usemtl gr\xe4ss\n"
    "f 2/5/2 5/3/2 3//2\n"
    "l 1 6\n";

Mesh read(const Scratch& scratch, const std::string& name, const std::string& text) {
    const auto file = read_mesh(scratch.write(name, text));
    CHECK(file.losses == std::vector<std::string>{});
    return file.mesh;
}

/// What writing loses, and the text.
struct Written {
    std::vector<std::string> losses;
    std::string text;
};

Written written(const Scratch& scratch, const std::string& name, const Mesh& mesh,
                const Placement* placement = nullptr) {
    Written out;
    out.losses = write_mesh(scratch / name, mesh, placement);
    out.text = Scratch::read(scratch / name);
    return out;
}

void check_same_shape(const Mesh& a, const Mesh& b) {
    CHECK(a.points == b.points);
    CHECK(a.corners == b.corners);
    CHECK(a.ends == b.ends);
}

}  // namespace

TEST_CASE(
    "an OBJ file comes back as it was: numbers, faces, UVs and normals per corner, groups and "
    "materials in their places") {
    const Scratch scratch;
    const auto mesh = read(scratch, "in.obj", small_obj);
    REQUIRE(mesh.points.size() == 6);
    CHECK(mesh.points[4] == Vec3d(2.5, 0.5, -0.123456789012345));
    REQUIRE(mesh.faces() == 2);
    CHECK(mesh.face(0).size() == 4);
    CHECK(mesh.face(1)[1] == 4);
    const auto* const uv = mesh.find("uv");
    REQUIRE(uv);
    CHECK(uv->on == Attribute::On::corners);
    CHECK(uv->at == std::vector<std::uint32_t>{0, 1, 2, 3, 4, 2, Attribute::none});
    CHECK(uv->entry(4)[0] == 0.6);
    REQUIRE(mesh.find("normal"));

    const auto out = written(scratch, "out.obj", mesh);
    CHECK(out.losses.empty());
    CHECK(out.text == small_obj);
}

TEST_CASE(
    "OBJ's other ways of saying the same are read: indices from the end, comments, colours, "
    "blanks, no end of the last line") {
    const Scratch scratch;
    const auto mesh =
        read(scratch, "a.obj",
             "v 0 0 0 1 0.5 0\r\nv +1 0 0 0 0 0 # two\r\n\r\n  v 0 1 0 0.25 0 1\r\n\tf -3 -2 -1");
    CHECK(mesh.points == std::vector<Vec3d>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    CHECK(mesh.corners == std::vector<std::uint32_t>{0, 1, 2});
    const auto* const colour = mesh.find("colour");
    REQUIRE(colour);
    CHECK(colour->entry(2)[0] == 0.25);
    CHECK(written(scratch, "b.obj", mesh).text ==
          "v 0 0 0 1 0.5 0\nv 1 0 0 0 0 0\nv 0 1 0 0.25 0 1\nf 1 2 3\n");
    // A face may name a vertex that comes later.
    CHECK(read(scratch, "c.obj", "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").corners ==
          std::vector<std::uint32_t>{0, 1, 2});
}

TEST_CASE(
    "a PLY file comes back byte by byte, in text and in both orders of bytes, with all properties "
    "under their names") {
    const Scratch scratch;
    for (const std::string format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
        INFO(format);
        const auto text = ply_of(format, format == "binary_big_endian");
        const auto mesh = read(scratch, "in.ply", text);
        REQUIRE(mesh.points.size() == 3);
        CHECK(mesh.points[1].y() == 1);
        CHECK(mesh.corners == std::vector<std::uint32_t>{0, 1, 2});
        REQUIRE(mesh.find("normal"));
        REQUIRE(mesh.find("uv"));
        REQUIRE(mesh.find("colour"));
        CHECK(mesh.find("colour")->parts.size() == 4);
        CHECK(mesh.find("colour")->entry(2)[1] == 2);
        CHECK(mesh.find("age")->entry(1)[0] == 0.1);
        CHECK(mesh.find("material")->on == Attribute::On::faces);
        CHECK(mesh.find("material")->entry(0)[0] == -5);
        const auto out = written(scratch, "out.ply", mesh);
        CHECK(out.losses.empty());
        if (format != "ascii") {
            CHECK(out.text == text);
        } else {
            const auto again = read(scratch, "again.ply", out.text);
            check_same_shape(again, mesh);
            CHECK(again.find("age")->values == mesh.find("age")->values);
            CHECK(out.text.find("\n0.1 1 -2 0 0 1 255 1 7 128 0.1 0.25 1\n") != std::string::npos);
        }
    }
}

TEST_CASE("what of a PLY file can't be kept is told") {
    const Scratch scratch;
    const auto file = read_mesh(
        scratch.write("a.ply",
                      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float "
                      "y\nproperty float z\nelement face 1\n"
                      "property list uchar int vertex_index\nproperty list uchar float "
                      "texcoord\nelement edge 1\nproperty int a\n"
                      "property int b\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 2 0 1\n0 1\n"));
    CHECK(file.losses ==
          std::vector<std::string>{"the list 'texcoord' of element 'face' is left out",
                                   "element 'edge' with 1 entries is left out"});
    CHECK(file.mesh.corners == std::vector<std::uint32_t>{0, 1, 2});
}

TEST_CASE("an OFF file comes back with its normals, colours and UVs, and the colours of faces") {
    const Scratch scratch;
    const std::string all =
        "STCNOFF\n3 1 0\n0.123456789012345 0 0 0 0 1 255 0 0 0 0\n1 0 0 0 0 1 0 255 0 1 0\n0 1 0 0 "
        "0 1 0 0 255 0 1\n3 0 1 2 10 20 30\n";
    const auto file = read_mesh(scratch.write("a.off", "# a comment\n" + all));
    CHECK(file.losses == std::vector<std::string>{"comments are left out"});
    const auto& mesh = file.mesh;
    CHECK(mesh.points[0].x() == 0.123456789012345);
    CHECK(mesh.find("colour")->type == Attribute::Type::uint8);
    CHECK(mesh.find("uv")->entry(1)[0] == 1);
    CHECK(written(scratch, "b.off", mesh).text == all);
    // Colours with a point reach from 0 to 1.
    const auto fractions =
        read(scratch, "c.off", "COFF 3 0 0\n0 0 0 1.0 1.0 1.0\n1 0 0 1 1 1\n0 1 0 0 0 0\n");
    CHECK(fractions.find("colour")->type == Attribute::Type::float64);
    CHECK(fractions.faces() == 0);
}

TEST_CASE("whole colours of OFF keep their meaning: 1.0 stays full light, and 1 a byte") {
    const Scratch scratch;
    for (const std::string one : {"1.0", "1"}) {
        const std::string zero = one == "1" ? "0" : "0.0",
                          light = " " + one + " " + zero + " " + zero;
        const auto text = "COFF\n3 1 0\n0 0 0" + light + "\n1 0 0" + light + "\n0 1 0" + light +
                          "\n3 0 1 2" + light + "\n";
        const auto mesh = read(scratch, "a.off", text);
        CHECK(mesh.find("colour")->type ==
              (one == "1" ? Attribute::Type::uint8 : Attribute::Type::float64));
        CHECK(written(scratch, "b.off", mesh).text == text);
    }
    // A single number is an index, which a byte may not hold.
    const std::string painted = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 70000\n";
    const auto mesh = read(scratch, "c.off", painted);
    CHECK(written(scratch, "c.off", mesh).text == painted);
    written(scratch, "c.ply", mesh);
    CHECK(read_mesh(scratch / "c.ply").mesh.attributes.at(0).values == std::vector<double>{70000});
}

TEST_CASE(
    "integer colours reach to their type's maximum, in whatever format they are written, and only "
    "OBJ's own weights become w") {
    const Scratch scratch;
    const auto mesh = read(scratch, "a.ply",
                           "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty "
                           "float y\nproperty float z\nproperty ushort red\n"
                           "property ushort green\nproperty ushort blue\nelement face 1\nproperty "
                           "list uchar int vertex_indices\nend_header\n"
                           "0 0 0 65535 0 257\n1 0 0 0 0 0\n0 1 0 0 0 0\n3 0 1 2\n");
    written(scratch, "a.obj", mesh);
    const auto obj = read_mesh(scratch / "a.obj").mesh;
    CHECK(obj.find("colour")->entry(0)[0] == 1);
    CHECK(obj.find("colour")->entry(0)[2] == Approx(1 / 255.0));
    const auto off = written(scratch, "a.off", mesh);
    CHECK(off.text.find("\n0 0 0 255 0 1\n") != std::string::npos);
    CHECK(off.losses ==
          std::vector<std::string>{
              "colours of vertices are rounded to bytes: .off holds no finer whole ones"});

    const std::string weighed = "v 0 0 0 2\nv 1 0 0 3\nv 0 1 0 4\nf 1 2 3\n";
    CHECK(written(scratch, "b.obj", read(scratch, "b.obj", weighed)).text == weighed);
    const auto skin = read(scratch, "b.ply",
                           "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty "
                           "float y\nproperty float z\nproperty float weight\n"
                           "end_header\n0 0 0 0.5\n");
    const auto out = written(scratch, "c.obj", skin);
    CHECK(out.text == "v 0 0 0\n");
    CHECK(out.losses.size() == 1);
}

TEST_CASE(
    "attributes that share a name alone with those of a format are told, not read beyond their "
    "width") {
    const Scratch scratch;
    const std::string head =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
        "float z\n";
    const std::string tail = "end_header\n0 0 0 5\n1 0 0 5\n0 1 0 5\n3 0 1 2 7 8 9\n";
    for (const std::string name : {"normal", "colour", "uv"}) {
        INFO(name);
        const auto mesh = read(
            scratch, "a.ply",
            head + "property float " + name +
                "\nelement face 1\nproperty list uchar int vertex_indices\nproperty float normal\n"
                "property float attribute\nproperty float colour\n" +
                tail);
        const auto stl = written(scratch, "a.stl", mesh), off = written(scratch, "a.off", mesh),
                   obj = written(scratch, "a.obj", mesh);
        for (const auto* const each : {&stl, &off, &obj}) CHECK(each->losses.size() == 4);
        CHECK(read_mesh(scratch / "a.stl").mesh.find("normal")->values ==
              std::vector<double>{0, 0, 1});
        CHECK(off.text == "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
        CHECK(obj.text == "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    }
}

TEST_CASE(
    "a number of PLY's faces that is called like their list is an attribute, and a list that is "
    "called like an axis is none") {
    const Scratch scratch;
    const std::string text =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
        "float z\nelement face 1\n"
        "property list uchar int vertex_indices\nproperty int vertex_index\nend_header\n0 0 0\n1 0 "
        "0\n0 1 0\n3 0 1 2 7\n";
    const auto mesh = read(scratch, "a.ply", text);
    CHECK(mesh.corners == std::vector<std::uint32_t>{0, 1, 2});
    REQUIRE(mesh.find("vertex_index"));
    CHECK(mesh.find("vertex_index")->values == std::vector<double>{7});
    CHECK(written(scratch, "b.ply", mesh).text == text);
    const auto listed =
        read_mesh(scratch.write("c.ply",
                                "ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar int "
                                "x\nproperty float x\nproperty float y\n"
                                "property float z\nend_header\n2 8 9 1 2 3\n"));
    CHECK(listed.mesh.points == std::vector<Vec3d>{{1, 2, 3}});
    CHECK(listed.losses ==
          std::vector<std::string>{"the list 'x' of element 'vertex' is left out"});
}

TEST_CASE(
    "PLY's whole coordinates stay whole where vertices stay, and keep their fractions where they "
    "move, and types that differ lose nothing") {
    const Scratch scratch;
    const auto head = [](const std::string& x, const std::string& z) {
        return "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty " + x +
               " x\nproperty " + x + " y\nproperty " + z + " z\n" +
               "element face 0\nproperty list uchar int vertex_indices\nend_header\n";
    };
    const std::int16_t low = -32768, one = 1, two = 2;
    const auto whole = head("short", "short") + bytes(low) + bytes(one) + bytes(two);
    auto mesh = read(scratch, "a.ply", whole);
    CHECK(written(scratch, "b.ply", mesh).text == whole);
    for (const Vec3d& moved : {Vec3d(0.5, 1, 2), Vec3d(0.1, 1, 2), Vec3d(32768, 1, 2)}) {
        mesh.points[0] = moved;
        written(scratch, "b.ply", mesh);
        CHECK(read_mesh(scratch / "b.ply").mesh.points[0] == moved);
    }
    const auto mixed =
        read(scratch, "c.ply", head("double", "short") + bytes(0.1) + bytes(0.2) + bytes(two));
    written(scratch, "d.ply", mixed);
    CHECK(read_mesh(scratch / "d.ply").mesh.points[0] == Vec3d(0.1, 0.2, 2));
}

TEST_CASE("a probe reads the head alone, and asks for a regular file") {
    const Scratch scratch;
    // So large that no memory holds it, but without a block on the disk.
    const auto huge = [&](const std::string& name, const std::string& head) {
        const auto path = scratch.write(name, head);
        std::filesystem::resize_file(path, std::uintmax_t{1} << 42);
        return path;
    };
    const std::string ply = "ply\nformat binary_little_endian 1.0\nelement vertex ";
    const std::string axes =
        "\nproperty double x\nproperty double y\nproperty double z\nend_header\n";
    CHECK_NOTHROW(probe_mesh(huge("a.obj", "v 0 0 0\n")));
    CHECK_NOTHROW(probe_mesh(huge("a.ply", ply + "100000000000" + axes)));
    CHECK_THROWS_WITH(probe_mesh(huge("b.ply", ply + "1000000000000" + axes)),
                      Catch::Contains("for which the file is too short"));
    CHECK_NOTHROW(probe_mesh(huge("a.off", "OFF\n100000 1000000 0\n")));
    CHECK_NOTHROW(probe_mesh(huge("a.stl", std::string(80, 'x') + "\xff\xff\xff\xff")));
    // Heads longer than is usual are heads too.
    std::string comments;
    for (int n = 0; n < 5000; ++n) comments += "comment of no use\n";
    CHECK_NOTHROW(probe_mesh(scratch.write(
        "c.ply", "ply\n" + comments + "format ascii 1.0\nelement vertex 1" + axes + "0 0 0\n")));

    const auto pipe = scratch / "pipe.obj";
    REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
    CHECK_THROWS_WITH(probe_mesh(pipe),
                      pipe + " is a pipe or a device; a mesh is read from a regular file");
}

TEST_CASE(
    "STL's triangles without an area have a normal of nan, which comes back, and of the tiniest "
    "others one is computed") {
    const Scratch scratch;
    const std::string text =
        "solid\nfacet normal nan nan nan\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 2 0 "
        "0\nendloop\nendfacet\nendsolid\n";
    CHECK(written(scratch, "a.stl", read(scratch, "a.stl", text)).text == text);
    Mesh tiny;
    tiny.points = {{0, 0, 0}, {1e-5, 0, 0}, {0, 1e-5, 0}};
    tiny.add_face(std::array<std::uint32_t, 3>{0, 1, 2});
    written(scratch, "b.stl", tiny);
    CHECK(read_mesh(scratch / "b.stl").mesh.find("normal")->values == std::vector<double>{0, 0, 1});
}

TEST_CASE("an STL file comes back as it was, its corners at one place made one vertex") {
    const Scratch scratch;
    const std::string text =
        "solid a b\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
        "0\nendloop\nendfacet\nendsolid\nsolid\nfacet normal 0 0 1\n"
        "outer loop\nvertex 1 0 0\nvertex 1.1 1 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n";
    const auto mesh = read(scratch, "a.stl", text);
    CHECK(mesh.points.size() == 4);
    CHECK(topology_of(mesh).boundary_edges == 4);
    CHECK(written(scratch, "b.stl", mesh).text == text);

    std::string binary(80, 'h');
    binary += bytes(std::uint32_t{2});
    for (int n = 0; n < 2; ++n) {
        for (const float c : {0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.1f, 1.0f, 0.0f, 0.0f, 0.0f,
                              static_cast<float>(1 - 2 * n), 0.0f})
            binary += bytes(c);
        binary += bytes(static_cast<std::uint16_t>(17 + n));
    }
    const auto two = read(scratch, "c.stl", binary);
    CHECK(two.points.size() == 4);
    CHECK(two.find("attribute")->entry(1)[0] == 18);
    CHECK(written(scratch, "d.stl", two).text == binary);
}

TEST_CASE("a mesh without faces comes back too") {
    const Scratch scratch;
    CHECK(written(scratch, "a.obj", read(scratch, "a.obj", "v 1 2 3\n")).text == "v 1 2 3\n");
    CHECK(written(scratch, "b.obj", read(scratch, "b.obj", "o nothing\n")).text == "o nothing\n");
    const std::string off = "OFF\n1 0 0\n1 2 3\n", stl = "solid none\nendsolid\n";
    CHECK(written(scratch, "a.off", read(scratch, "a.off", off)).text == off);
    CHECK(written(scratch, "a.stl", read(scratch, "a.stl", stl)).text == stl);
    const auto ply = read(scratch, "a.ply",
                          "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty "
                          "float y\nproperty float z\nend_header\n1 2 3\n");
    CHECK(ply.points == std::vector<Vec3d>{{1, 2, 3}});
    CHECK(written(scratch, "c.obj", Mesh{}).text == "o nothing\n");
    CHECK(read(scratch, "b.ply", written(scratch, "b.ply", ply).text).faces() == 0);
}

TEST_CASE("between formats all travels that the other can hold, and the rest is told exactly") {
    const Scratch scratch;
    const auto mesh = read(scratch, "a.obj", small_obj);
    const auto ply = written(scratch, "a.ply", mesh);
    CHECK(ply.losses ==
          std::vector<std::string>{"UVs of corners are not written: .ply holds one per vertex, and "
                                   "2 vertices have several or corners without",
                                   "normals of corners are not written: .ply holds one per vertex, "
                                   "and 2 vertices have several or corners without",
                                   "groups, materials, lines and the like of the .obj file are not "
                                   "written: .ply holds none"});
    check_same_shape(read_mesh(scratch / "a.ply").mesh, mesh);
    const auto off = written(scratch, "a.off", mesh);
    CHECK(off.losses.size() == 3);
    check_same_shape(read_mesh(scratch / "a.off").mesh, mesh);
    const auto stl = written(scratch, "a.stl", mesh);
    CHECK(stl.losses[0] ==
          "UVs of corners are not written: .stl holds nothing but triangles and their normals");
    CHECK(std::ranges::count(
              stl.losses,
              "1 faces of more than three corners are written as triangles: .stl has no others") ==
          1);
    CHECK(std::ranges::count(stl.losses,
                             "1 vertices without a face are not written: .stl has none") == 1);
    CHECK(read_mesh(scratch / "a.stl").mesh.faces() == 3);

    // One UV per vertex is all that PLY and OFF need.
    const auto single = read(scratch, "b.obj",
                             "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/3 2/2 3/1\n");
    for (const std::string name : {"b.ply", "b.off"}) {
        CHECK(written(scratch, name, single).losses.empty());
        CHECK(read_mesh(scratch / name).mesh.find("uv")->values ==
              std::vector<double>{0, 1, 1, 0, 0, 0});
    }
    // And back: vertices' UVs and normals, and colours as fractions.
    const auto coloured = read(scratch, "c.ply", ply_of("ascii", false));
    const auto obj = written(scratch, "c.obj", coloured);
    CHECK(obj.losses == std::vector<std::string>{
                            "'age' of vertices are not written: .obj holds none of vertices",
                            "'material' of faces are not written: .obj holds none of faces"});
    CHECK(obj.text.find("\nf 1/1/1 2/2/2 3/3/3\n") != std::string::npos);
    CHECK(read_mesh(scratch / "c.obj").mesh.find("colour")->entry(0)[0] == 1);
}

TEST_CASE(
    "a placement is undone to the file's own numbers, and moved vertices go back into its space") {
    const Scratch scratch;
    auto mesh = placed(read(scratch, "a.obj", small_obj), {Vec3d(0.3, -7.7, 1e3), 0.0533333});
    CHECK((mesh.points[1] - Vec3d(0.3533333, -7.7, 1000 + 0.0533333e-5)).length() < 1e-12);
    CHECK(written(scratch, "b.obj", mesh).text == small_obj);
    mesh.points[5] += Vec3d(0.0533333, 0, 0);
    const auto moved = read_mesh(scratch.write("c.obj", written(scratch, "c.obj", mesh).text)).mesh;
    CHECK(moved.points[4] == Vec3d(2.5, 0.5, -0.123456789012345));
    CHECK((moved.points[5] - Vec3d(8, 8, 9)).length() < 1e-10);
    const Placement other{Vec3d(1, 0, 0), 2};
    CHECK(written(scratch, "d.obj", cube(2), &other).text.starts_with("v -0.5 0 0\nv 0.5 0 0\n"));
}

TEST_CASE(
    "mesh.read warns of what is unusual, places, and holds or misses frames, and mesh.write wants "
    "an ending that it knows") {
    const Scratch scratch;
    const auto path = scratch.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 2\n");
    test::NodeBench bench(mesh_read(), "{path: " + path + ", translate: [1, 0, 0], scale: 2}");
    REQUIRE(bench.faults().empty());
    struct Heard : Context::Host {
        std::vector<std::string> warnings;
        void warn(const std::string& message) override { warnings.push_back(message); }
    } heard;
    const std::vector<int> frames{1};
    const auto mesh = bench.run({}, Context(heard, frames)).at("mesh").as<Mesh>();
    CHECK(mesh->points[1] == Vec3d(3, 0, 0));
    CHECK(heard.warnings ==
          std::vector<std::string>{"1 face with a vertex twice: they are kept as they are"});
    CHECK(test::NodeBench(mesh_read(), "{path: a.abc}").faults() ==
          "path: a.abc: a mesh is a .obj, .ply, .off or .stl file, not '.abc'\n");
    CHECK(test::NodeBench(mesh_write(), "{path: a}").faults() ==
          "path: a: a mesh is a .obj, .ply, .off or .stl file, not ''; for USD, write a .usda "
          "file\n");
    CHECK(test::NodeBench(mesh_read(), "{path: a.obj, missing: hold}").faults() != "");
}
