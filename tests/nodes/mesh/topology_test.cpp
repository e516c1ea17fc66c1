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
#include <cmath>
#include <numeric>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Vec3d;
using Attribute = Mesh::Attribute;

namespace {

/// The area of the triangles that a polygon is cut into, all of them turned like it.
/// @return below 0 if they run clockwise, seen from above
double area_of_parts(const std::vector<Vec3d>& points) {
    std::vector<std::uint32_t> face(points.size());
    std::iota(face.begin(), face.end(), 0u);
    std::vector<std::array<std::uint32_t, 3>> parts;
    triangulate(points, face, parts);
    REQUIRE(parts.size() == face.size() - 2);
    double sum = 0, sizes = 0;
    for (const auto& [a, b, c] : parts) {
        const double area = 0.5 * (points[b] - points[a]).cross(points[c] - points[a]).z();
        sum += area;
        sizes += std::abs(area);
    }
    CHECK(sizes == Approx(std::abs(sum)));
    return sum;
}

}  // namespace

TEST_CASE("what is unusual about how faces hang together is counted") {
    CHECK(topology_of(cube(1)).closed());
    CHECK(faults_of(topology_of(cube(1))).empty());
    auto open = cube(1);
    open.corners.resize(20);
    open.ends.resize(5);
    CHECK(topology_of(open).boundary_edges == 4);
    CHECK(!topology_of(open).closed());
    auto winged = cube(1);
    winged.points.emplace_back(2, 2, 2);
    winged.add_face(std::array<std::uint32_t, 3>{0, 1, 8});
    winged.add_face(std::array<std::uint32_t, 3>{0, 1, 1});
    winged.points.emplace_back(3, 3, 3);
    const auto topology = topology_of(winged);
    CHECK(topology.non_manifold_faces == 1);
    CHECK(topology.degenerate_faces == 1);
    CHECK(!topology.closed());
    CHECK(faults_of(topology) ==
          "1 face beyond two at an edge, turned against their neighbours, or touching others at a "
          "vertex alone, and 1 face with a vertex twice");
}

TEST_CASE("a concave face is cut along its own diagonals") {
    // A comb seen from below: the triangles' areas add up to its own, none lies beside it.
    std::vector<Vec3d> points;
    for (int n = 0; n <= 8; ++n) points.emplace_back(n, n % 2 == 0 ? 5 : 1, 0.1);
    points.emplace_back(8, 0, 0.1);
    points.emplace_back(0, 0, 0.1);
    CHECK(area_of_parts(points) == Approx(-24));
    std::ranges::reverse(points);
    CHECK(area_of_parts(points) == Approx(24));
}

TEST_CASE("a face of very many corners is cut in a moment, where hardly any is an ear") {
    // A thin zigzag band: in each peak's triangle lies the corner beneath it.
    const int side = 4000;
    const Vec3d far(1e6, 1e6, 0);
    std::vector<Vec3d> points;
    for (int n = 0; n < side; ++n) points.push_back(far + Vec3d(n, n % 2, 0));
    for (int n = side - 1; n >= 0; --n) points.push_back(far + Vec3d(n, n % 2 + 0.25, 0));
    CHECK(area_of_parts(points) == Approx(0.25 * (side - 1)));
}

TEST_CASE("how a face lies is told far away from the origin, too") {
    // So small and so far that products of its coordinates lose its area. The corner at (2, 1)
    // points inwards.
    const std::array<Vec3d, 5> corners{{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 1, 0}, {0, 4, 0}}};
    for (int axis = 0; axis < 3; ++axis)
        for (std::uint32_t first = 0; first < 5; ++first) {
            std::vector<Vec3d> points;
            for (const auto& at : corners)
                points.push_back(Vec3d(3.1e7, -2.3e7, 5.7e7) +
                                 0.01 * Vec3d(at[axis], at[(axis + 1) % 3], at[(axis + 2) % 3]));
            std::vector<std::uint32_t> face;
            for (std::uint32_t n = 0; n < 5; ++n) face.push_back((first + n) % 5);
            std::vector<std::array<std::uint32_t, 3>> parts;
            triangulate(points, face, parts);
            double sizes = 0;
            for (const auto& [a, b, c] : parts)
                sizes += 0.5 * (points[b] - points[a]).cross(points[c] - points[a]).length();
            CHECK(sizes == Approx(1e-4 * 10).epsilon(1e-3));
        }
}
