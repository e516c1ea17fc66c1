#include "formats/seam_file/curves.h"

#include "formats/geometry_file/file_text.h"
#include "formats/geometry_file/ply.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

#include <cstring>

using namespace fluidcarve;

namespace {

/// Two seams in a box of 4 x 3 x 2 vertices, one frame.
Seams two_seams(const Lattice& lattice, Seams::Kind kind) {
    Seams out;
    out.kind = kind;
    out.shape = lattice.shape;
    out.frames = {7};
    out.lattice_hash = lattice.hash;
    out.seams.push_back({{1, 1, 2, 1, 2, 2}});
    out.seams.push_back({{1, 1, 1, 1, 1, 1}});
    return out;
}

Lattice small_box() { return make_box(openvdb::Vec3d(10, 0, 0), {4, 3, 2}, 0.5, {0, 1, 2}); }

}  // namespace

TEST_CASE("the curves of a seam run through the vertices that it removes") {
    const auto lattice = small_box();
    const auto curves = seam_curves(lattice, two_seams(lattice, Seams::Kind::remove), 7, {1, 1});
    REQUIRE(curves.size() == 2);
    REQUIRE(curves[0].vertices.size() == 6);
    CHECK(curves[0].vertices[0] == openvdb::Vec3d(10.5, 0, 0));
    CHECK(curves[0].vertices[2] == openvdb::Vec3d(11, 1, 0));
    // The second seam counts what the first leaves: where that took vertex 1, it takes vertex 2.
    CHECK(curves[1].vertices[0] == openvdb::Vec3d(11, 0, 0));
    CHECK(curves[1].vertices[2] == openvdb::Vec3d(10.5, 1, 0));
    CHECK(curves[0].colour != curves[1].colour);
    // Three columns across, two planes: two edges in each plane, three between them.
    CHECK(curves[0].edges.size() == 7);
    CHECK_THROWS(seam_curves(lattice, two_seams(lattice, Seams::Kind::remove), 8, {1, 1}));
}

TEST_CASE(
    "curves of insertions lie half a vertex behind the doubled ones, and fewer curves share the "
    "same edges") {
    const auto lattice = small_box();
    const auto curves = seam_curves(lattice, two_seams(lattice, Seams::Kind::insert), 7, {2, 1});
    CHECK(curves[0].vertices[0] == openvdb::Vec3d(10.75, 0, 0));
    CHECK(curves[0].edges.size() == 4 + 2);
}

TEST_CASE("a PLY of seams has vertices and edges in the colours of the seams") {
    const Scratch scratch;
    const auto lattice = small_box();
    const auto curves = seam_curves(lattice, two_seams(lattice, Seams::Kind::remove), 7, {1, 1});
    write_seam_curves(scratch / "seams.ply", curves, {{"fluidcarve_version", "1"}});
    FileText file(InputFile(scratch / "seams.ply", {.what = "a test file"}));
    PlyHeader header;
    while (file.next())
        if (file.line() != "ply" && header.take(file.line()).kind == PlyStatement::Kind::end) break;
    CHECK(header.comments == std::vector<std::string>{"comment fluidcarve_version: 1"});
    REQUIRE(header.elements.size() == 2);
    CHECK(header.elements[0].name == "vertex");
    CHECK(header.elements[0].count == 12);
    CHECK(header.elements[1].name == "edge");
    CHECK(header.elements[1].count == 14);
    CHECK(header.elements[1].properties[0].name == "vertex1");
    constexpr std::size_t vertex_bytes = 3 * 4 + 3, edge_bytes = 2 * 4 + 3;
    const auto bytes = std::string(file.rest());
    REQUIRE(bytes.size() == 12 * vertex_bytes + 14 * edge_bytes);
    const auto colour_at = [&](std::size_t at) {
        return std::array{static_cast<std::uint8_t>(bytes[at]),
                          static_cast<std::uint8_t>(bytes[at + 1]),
                          static_cast<std::uint8_t>(bytes[at + 2])};
    };
    float x = 0;
    std::memcpy(&x, bytes.data() + 6 * vertex_bytes, sizeof x);
    CHECK(x == 11);
    CHECK(colour_at(12) == curves[0].colour);
    CHECK(colour_at(6 * vertex_bytes + 12) == curves[1].colour);
    for (std::size_t edge = 0; edge < 14; ++edge) {
        const auto at = 12 * vertex_bytes + edge * edge_bytes;
        std::array<std::int32_t, 2> ends{};
        std::memcpy(ends.data(), bytes.data() + at, sizeof ends);
        for (const auto end : ends) CHECK(end / 6 == static_cast<int>(edge / 7));
        CHECK(colour_at(at + 8) == curves[edge / 7].colour);
    }
}

TEST_CASE("an OBJ of seams has an object of lines for each") {
    const Scratch scratch;
    const auto lattice = small_box();
    write_seam_curves(scratch / "seams.obj",
                      seam_curves(lattice, two_seams(lattice, Seams::Kind::remove), 7, {1, 1}));
    const auto text = Scratch::read(scratch / "seams.obj");
    CHECK_THAT(text, Catch::StartsWith("o seam_0000\nv 10.5 0 0\n"));
    CHECK_THAT(text, Catch::Contains("\no seam_0001\nv 11 0 0\n"));
    // The second object's lines name its own vertices, which go on from the first.
    CHECK_THAT(text.substr(text.find("seam_0001")), Catch::Contains("\nl 7 8\n"));
}
