#include "carve/time/mesh_between.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;
using openvdb::Vec3d;

namespace {

Mesh triangle(double z, NumberType type) {
    Mesh out;
    out.points = {Vec3d(0, 0, z), Vec3d(1, 0, z), Vec3d(0, 1, 2 * z)};
    out.add_face(std::vector<std::uint32_t>{0, 1, 2});
    out.attributes.push_back(
        {"heat", Mesh::Attribute::On::vertices, {"heat"}, type, {z, z, 2 * z}, {}});
    return out;
}

}  // namespace

TEST_CASE("vertices and floats of a mesh lie on straight ways, whole numbers in the nearer frame") {
    const auto a = triangle(1, NumberType::float32), b = triangle(3, NumberType::float32);
    REQUIRE(same_faces(a, b));
    for (const double share : {0.25, 0.75}) {
        const auto between = mesh_between(a, b, share);
        CHECK(between.points[0].z() == Approx(1 + 2 * share));
        CHECK(between.points[2].z() == Approx(2 + 4 * share));
        CHECK(between.attributes[0].values[2] == Approx(2 + 4 * share));
        CHECK(same_faces(between, a));
    }
    const auto whole =
        mesh_between(triangle(1, NumberType::int32), triangle(3, NumberType::int32), 0.75);
    CHECK(whole.points[0].z() == Approx(2.5));
    CHECK(whole.attributes[0].values[0] == 3);
}

TEST_CASE("meshes of other faces do not have the same") {
    auto a = triangle(1, NumberType::float32), b = a;
    b.corners = {0, 2, 1};
    CHECK(!same_faces(a, b));
    b = a;
    b.points.emplace_back(1);
    CHECK(!same_faces(a, b));
}

TEST_CASE("the distance of two meshes is the mean of their vertices' squares") {
    CHECK(squared_distance(triangle(1, NumberType::float32), triangle(3, NumberType::float32)) ==
          Approx((4 + 4 + 16) / 3.0));
    CHECK(squared_distance(Mesh(), Mesh()) == 0);
}

TEST_CASE("each vertex of a mesh, and what lies on it, is at the moment of its place") {
    const auto a = triangle(1, NumberType::float32), b = triangle(3, NumberType::float32);
    const auto share = [](const Vec3d& at) { return at.y(); };
    const auto between = mesh_between(a, b, share, b);
    CHECK(between.points[0] == a.points[0]);
    CHECK(between.points[2] == b.points[2]);
    CHECK(between.attributes[0].values == std::vector<double>{1, 1, 6});
    auto c = b;
    c.corners = {0, 2, 1};
    CHECK(mesh_between(a, c, share, c).corners == c.corners);
    CHECK(mesh_between(a, c, share, a).points == a.points);
}
