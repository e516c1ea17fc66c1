#include "carve/mask/below_surface.h"
#include "carve/mask/mesh.h"
#include "carve/sdf/from_mesh.h"
#include "carve/sdf/to_mesh.h"
#include "formats/mesh_file/topology.h"
#include "nodes/mask.h"
#include "nodes/sdf.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/node_bench.h"
#include "tests/support/sampled.h"

#include <openvdb/tools/LevelSetSphere.h>

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

namespace {

/// A box of quads, turned outwards; without its top it is open.
Mesh boxed(const Vec3d& low, const Vec3d& high, bool open = false) {
    Mesh out;
    for (int n = 0; n < 8; ++n)
        out.points.emplace_back((n & 1 ? high : low)[0], (n & 2 ? high : low)[1],
                                (n & 4 ? high : low)[2]);
    const std::array<std::array<std::uint32_t, 4>, 6> quads{
        {{0, 2, 3, 1}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}, {4, 5, 7, 6}}};
    for (const auto& quad : quads)
        if (!open || quad[0] != 4) out.add_face(quad);
    return out;
}

double box_distance(const Vec3d& at, const Vec3d& low, const Vec3d& high) {
    Vec3d out(0);
    double inside = -1e9;
    for (int c = 0; c < 3; ++c) {
        const double beyond = std::max(low[c] - at[c], at[c] - high[c]);
        out[c] = std::max(0.0, beyond);
        inside = std::max(inside, beyond);
    }
    return inside > 0 ? out.length() : inside;
}

openvdb::math::Transform::Ptr voxels(double size) {
    return openvdb::math::Transform::createLinearTransform(size);
}

std::set<std::array<int, 3>> set_of(const MaskGrid& mask, const CoordBBox& box) {
    std::set<std::array<int, 3>> out;
    auto values = mask.getConstAccessor();
    for (auto at = box.begin(); at; ++at)
        if (values.isValueOn(*at)) out.insert({(*at).x(), (*at).y(), (*at).z()});
    return out;
}

template <class Wanted>
void check_mask(const MaskGrid& mask, const CoordBBox& box, const Wanted& wanted) {
    std::set<std::array<int, 3>> expected;
    for (auto at = box.begin(); at; ++at)
        if (wanted(*at)) expected.insert({(*at).x(), (*at).y(), (*at).z()});
    REQUIRE(!expected.empty());
    CHECK((set_of(mask, box) == expected));
    CHECK(mask.activeVoxelCount() == expected.size());
}

}  // namespace

TEST_CASE("a closed mesh becomes a level set of its distances, signed") {
    const Vec3d low(-0.31, 0.12, 1.03), high(0.57, 1.04, 1.72);
    const auto surface = mesh_distance(boxed(low, high), *voxels(0.05), 4, std::nullopt);
    CHECK(surface->getGridClass() == openvdb::GRID_LEVEL_SET);
    CHECK(surface->getName() == "surface");
    CHECK(surface->background() == Approx(0.2));
    int count = 0;
    for (auto voxel = surface->cbeginValueOn(); voxel; ++voxel, ++count) {
        const double expected = box_distance(surface->indexToWorld(voxel.getCoord()), low, high);
        // Further out OpenVDB's distances are those to faces near the nearest one.
        if (std::abs(expected) < 0.1)
            REQUIRE(*voxel ==
                    Approx(expected).margin(std::abs(expected) < 0.05 ? 1e-5 : 0.1 * 0.05));
        else REQUIRE(*voxel * expected > 0);
    }
    CHECK(count > 1000);
    CHECK(surface->tree().getValue(Coord(2, 12, 28)) == Approx(-0.2));
}

TEST_CASE("boxes that touch at an edge, or are turned inside out, have an inside too") {
    auto two = boxed(Vec3d(0), Vec3d(1));
    for (auto& point : boxed(Vec3d(1, 1, 0), Vec3d(2, 2, 1)).points) two.points.push_back(point);
    // The second box begins at the first one's edge from (1, 1, 0) to (1, 1, 1).
    for (std::size_t n = 0; n < 24; ++n) {
        const auto vertex = two.corners[n] + 8;
        two.corners.push_back(vertex == 8 ? 3 : vertex == 12 ? 7 : vertex);
    }
    for (std::size_t n = 1; n <= 6; ++n) two.ends.push_back(24 + 4 * n);
    std::reverse(two.corners.begin() + 24, two.corners.end());
    REQUIRE(topology_of(two).non_manifold_faces > 0);
    const auto surface = mesh_distance(two, *voxels(0.05), 3, std::nullopt);
    CHECK(surface->getGridClass() == openvdb::GRID_LEVEL_SET);
    for (const auto& inside :
         {Coord(10, 10, 10), Coord(30, 30, 10), Coord(1, 1, 1), Coord(39, 39, 19)})
        CHECK(surface->tree().getValue(inside) < 0);
    for (const auto& outside :
         {Coord(30, 10, 10), Coord(10, 30, 10), Coord(-1, 5, 5), Coord(50, 50, 50)})
        CHECK(surface->tree().getValue(outside) > 0);
}

TEST_CASE("an open mesh has distances without a sign, or a shell of a thickness") {
    const auto sheet = boxed(Vec3d(0), Vec3d(1), true);
    const auto around = mesh_distance(sheet, *voxels(0.05), 3, std::nullopt);
    CHECK(around->getGridClass() == openvdb::GRID_UNKNOWN);
    CHECK(around->tree().getValue(Coord(10, 10, -2)) == Approx(0.1));
    CHECK(around->tree().getValue(Coord(10, 10, 2)) == Approx(0.1));
    for (auto voxel = around->cbeginValueOn(); voxel; ++voxel) REQUIRE(*voxel >= 0);

    const auto shell = mesh_distance(sheet, *voxels(0.05), 3, 0.24);
    CHECK(shell->getGridClass() == openvdb::GRID_LEVEL_SET);
    CHECK(shell->tree().getValue(Coord(10, 10, -2)) == Approx(-0.02));
    CHECK(shell->tree().getValue(Coord(10, 10, 0)) == Approx(-0.12));
    CHECK(shell->tree().getValue(Coord(10, 10, 4)) == Approx(0.08));
    CHECK(shell->tree().getValue(Coord(10, 10, 10)) == Approx(0.15));
    CHECK(!shell->tree().isValueOn(Coord(10, 10, 10)));
    // Thicker than the band is wide: what lies within is inside, but no part of it.
    const auto thick = mesh_distance(sheet, *voxels(0.05), 2, 0.5);
    CHECK(thick->tree().getValue(Coord(10, 10, 0)) == Approx(-0.1));
    CHECK(!thick->tree().isValueOn(Coord(10, 10, 0)));
    CHECK(thick->tree().getValue(Coord(10, 10, -4)) == Approx(-0.05));
}

TEST_CASE("a mesh that would fill the memory, or lies too far away, is refused") {
    CHECK_THROWS_WITH(mesh_distance(boxed(Vec3d(0), Vec3d(1000)), *voxels(0.01), 3, std::nullopt),
                      Catch::StartsWith("the mesh reaches 1e+05 voxels") ||
                          Catch::Contains("voxels, more than 1e+09; choose larger voxels"));
    CHECK_THROWS_WITH(mesh_distance(boxed(Vec3d(1e7), Vec3d(1e7 + 1)), *voxels(1), 3, std::nullopt),
                      Catch::Contains("away from the grid's origin"));
    CHECK(mesh_distance(Mesh{}, *voxels(1), 3, std::nullopt)->activeVoxelCount() == 0);
}

TEST_CASE(
    "the size of a band counts what lies around edges and corners, but where triangles share it "
    "once") {
    Mesh speck;
    speck.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    speck.add_face(std::array<std::uint32_t, 3>{0, 1, 2});
    CHECK_THROWS_WITH(
        near_mask(speck, *voxels(1), 650),
        Catch::Contains("voxels, more than 1e+09; choose larger voxels, or a narrower band"));
    CHECK_THROWS_WITH(mesh_distance(speck, *voxels(1), 650, std::nullopt),
                      Catch::Contains("voxels, more than 1e+09"));
    // Two sheets of many small triangles, whose bands one by one would be far too many, as would be
    // the box around both.
    Mesh sheets;
    const int side = 72;
    for (const int place : {0, 10000}) {
        const auto first = static_cast<std::uint32_t>(sheets.points.size());
        for (int n = 0; n < side * side; ++n)
            sheets.points.emplace_back(place + n % side, place + n / side, place);
        for (std::uint32_t n = first; n < first + side * (side - 1); ++n)
            if ((n - first) % side + 1 < side)
                sheets.add_face(std::array<std::uint32_t, 4>{n, n + 1, n + side + 1, n + side});
    }
    CHECK(mesh_distance(sheets, *voxels(1), 30, std::nullopt)
              ->tree()
              .getValue(Coord(10030, 10030, 10011)) == Approx(11));
}

TEST_CASE("the mesh of a level set lies on its surface, is closed, and is turned outwards") {
    const auto ball =
        openvdb::tools::createLevelSetSphere<FloatGrid>(1.0f, openvdb::Vec3f(2, 0, 0), 0.1f, 3);
    for (const double adaptivity : {0.0, 0.5}) {
        const auto mesh = surface_mesh(*ball, 0, adaptivity);
        CHECK(topology_of(mesh).closed());
        std::size_t quads = 0;
        for (std::size_t n = 0; n < mesh.faces(); ++n) {
            const auto face = mesh.face(n);
            quads += face.size() == 4;
            const auto& a = mesh.points[face[0]];
            const auto normal = (mesh.points[face[1]] - a).cross(mesh.points[face[2]] - a);
            REQUIRE(normal.dot(a - Vec3d(2, 0, 0)) > 0);
        }
        CHECK((adaptivity == 0) == (quads == mesh.faces()));
        for (const auto& point : mesh.points)
            REQUIRE((point - Vec3d(2, 0, 0)).length() ==
                    Approx(1).margin(adaptivity == 0 ? 0.02 : 0.1));
    }
    CHECK(surface_mesh(*ball, 0, 0.5).faces() < surface_mesh(*ball, 0, 0).faces());
    for (const auto& point : surface_mesh(*ball, 0.15, 0).points)
        REQUIRE((point - Vec3d(2, 0, 0)).length() == Approx(1.15).margin(0.02));
    // And back.
    const auto again = mesh_distance(surface_mesh(*ball, 0, 0), ball->transform(), 3, std::nullopt);
    double worst = 0;
    for (auto voxel = again->cbeginValueOn(); voxel; ++voxel)
        if (std::abs(*voxel) < 0.1)
            worst =
                std::max<double>(worst, std::abs(*voxel - ball->tree().getValue(voxel.getCoord())));
    CHECK(worst < 0.02);
}

TEST_CASE("faces are turned outwards whatever the class of the grid says, and for densities too") {
    /// What the faces enclose: below 0 if they are turned inwards.
    const auto volume = [](const FloatGrid& grid, double isovalue) {
        const auto mesh = surface_mesh(grid, isovalue, 0);
        double out = 0;
        for (std::size_t n = 0; n < mesh.faces(); ++n) {
            const auto face = mesh.face(n);
            for (std::size_t c = 2; c < face.size(); ++c)
                out +=
                    mesh.points[face[0]].dot(mesh.points[face[c - 1]].cross(mesh.points[face[c]])) /
                    6;
        }
        return out;
    };
    const auto of_ball = [](double radius) {
        return Approx(4.0 / 3 * openvdb::math::pi<double>() * radius * radius * radius)
            .epsilon(0.02);
    };
    const auto ball =
        openvdb::tools::createLevelSetSphere<FloatGrid>(1.0f, openvdb::Vec3f(2, 0, 0), 0.1f, 3);
    for (const auto grid_class :
         {openvdb::GRID_LEVEL_SET, openvdb::GRID_UNKNOWN, openvdb::GRID_FOG_VOLUME}) {
        ball->setGridClass(grid_class);
        CHECK(volume(*ball, 0) == of_ball(1));
        CHECK(ball->getGridClass() == grid_class);
    }
    FloatGrid density(0);
    density.setTransform(ball->transform().copy());
    for (auto voxel = ball->cbeginValueOn(); voxel; ++voxel)
        density.tree().setValue(voxel.getCoord(), 0.5f - *voxel);
    for (auto tile = ball->cbeginValueOff(); tile; ++tile)
        if (*tile < 0)
            density.tree().addTile(
                static_cast<openvdb::Index>(openvdb::FloatTree::DEPTH) - 1 - tile.getDepth(),
                tile.getCoord(), 1, true);
    CHECK(volume(density, 0.4) == of_ball(1.1));
}

TEST_CASE("a grid of tiles alone has a surface too") {
    FloatGrid tiles(1);
    tiles.tree().addTile(1, Coord(8, 8, 8), -1, true);
    tiles.tree().addTile(1, Coord(16, 8, 8), -1, true);
    const auto mesh = surface_mesh(tiles, 0, 0);
    CHECK(topology_of(mesh).closed());
    openvdb::BBoxd box;
    for (const auto& point : mesh.points) box.expand(point);
    CHECK((box.min() - Vec3d(7.5)).length() < 0.5);
    CHECK((box.max() - Vec3d(23.5, 15.5, 15.5)).length() < 0.5);
    CHECK(mesh.faces() > 2 * (64 + 128 + 128) / 2);
}

TEST_CASE(
    "sdf.from_mesh takes its voxels from a size or from a grid, and warns where a mesh has no "
    "inside") {
    CHECK(NodeBench(sdf_from_mesh()).faults() ==
          "type: needs 'voxel_size', or a grid 'like' whose voxels it takes\n");
    CHECK(NodeBench(sdf_from_mesh(), "{voxel_size: 1}", {{"like", 1}}).faults() ==
          "voxel_size: 'like' already states the voxels; leave 'like' or 'voxel_size' out\n");
    const auto like = FloatGrid::create();
    like->setTransform(voxels(0.1));
    like->transform().postTranslate(Vec3d(0.03, 0, 0));
    NodeBench bench(sdf_from_mesh(), "{}", {{"like", 1}});
    struct Heard : Context::Host {
        std::vector<std::string> warnings;
        void warn(const std::string& message) override { warnings.push_back(message); }
    } heard;
    const std::vector<int> frames{1};
    const auto run = [&](const Mesh& mesh) {
        return bench
            .run({{"mesh", {Payload(std::make_shared<Mesh>(mesh))}},
                  {"like", {Payload(std::make_shared<AnyGrid>(AnyGrid{like}))}}},
                 Context(heard, frames))
            .at("surface")
            .as<FloatGrid>();
    };
    CHECK(run(boxed(Vec3d(0), Vec3d(1)))->transform() == like->transform());
    CHECK(heard.warnings.empty());
    run(boxed(Vec3d(0), Vec3d(1), true));
    REQUIRE(heard.warnings.size() == 1);
    CHECK(heard.warnings[0].starts_with("the mesh is not closed"));
}

TEST_CASE(
    "frames that share a mesh and its voxels share the distances and masks that nodes make of it") {
    const auto mesh = std::make_shared<Mesh>(boxed(Vec3d(0), Vec3d(1))),
               other = std::make_shared<Mesh>(boxed(Vec3d(0), Vec3d(0.5)));
    const auto like = [](double size) {
        const auto out = FloatGrid::create();
        out->setTransform(voxels(size));
        return Payload(std::make_shared<AnyGrid>(AnyGrid{out}));
    };
    const auto check = [&]<class GridT>(NodeBench bench, const char* output, GridT*) {
        const auto run = [&](const std::shared_ptr<Mesh>& of, double size) {
            return bench.run({{"mesh", {Payload(of)}}, {"like", {like(size)}}})
                .at(output)
                .template as<GridT>();
        };
        const auto first = run(mesh, 0.1);
        CHECK(run(mesh, 0.1) == first);
        const auto coarse = run(mesh, 0.2), small = run(other, 0.2);
        CHECK(coarse->voxelSize() == Vec3d(0.2));
        CHECK(small->activeVoxelCount() < coarse->activeVoxelCount());
        CHECK(bytes(run(mesh, 0.1)->tree()) == bytes(first->tree()));
    };
    check(NodeBench(sdf_from_mesh(), "{}", {{"like", 1}}), "surface",
          static_cast<FloatGrid*>(nullptr));
    check(NodeBench(mask_mesh(), "{}", {{"like", 1}}), "mask", static_cast<MaskGrid*>(nullptr));
}

TEST_CASE("a mesh that can't be made into a grid fails in each frame, not in the first alone") {
    NodeBench bench(mask_mesh(), "{}", {{"like", 1}});
    const auto open = std::make_shared<Mesh>(boxed(Vec3d(0), Vec3d(1), true));
    const auto like = std::make_shared<AnyGrid>(AnyGrid{FloatGrid::create()});
    for (int frame = 0; frame < 2; ++frame) {
        INFO(frame);
        CHECK(failure_of([&] {
                  bench.run({{"mesh", {Payload(open)}}, {"like", {Payload(like)}}});
              }).starts_with("the mesh is not closed"));
    }
}

TEST_CASE("the voxels in a mesh, and near it, are those whose centres are") {
    const Vec3d low(-0.31, 0.12, 1.03), high(0.57, 3.04, 1.72);
    const auto mesh = boxed(low, high);
    const CoordBBox box(Coord(-20, -20, 0), Coord(30, 80, 60));
    const auto at = [](const Coord& voxel) { return 0.05 * voxel.asVec3d(); };
    check_mask(*inside_mask(mesh, *voxels(0.05)), box,
               [&](const Coord& voxel) { return box_distance(at(voxel), low, high) < 0; });
    check_mask(*near_mask(mesh, *voxels(0.05), 0.021), box, [&](const Coord& voxel) {
        return std::abs(box_distance(at(voxel), low, high)) <= 0.021;
    });
    const auto near = near_mask(mesh, *voxels(0.05), 0.23);
    for (auto voxel = box.begin(); voxel; ++voxel) {
        const double distance = std::abs(box_distance(at(*voxel), low, high));
        if (std::abs(distance - 0.23) > 0.1 * 0.05)
            REQUIRE(near->tree().isValueOn(*voxel) == (distance < 0.23));
    }
    CHECK_THROWS_WITH(inside_mask(boxed(low, high, true), *voxels(0.05)),
                      "the mesh is not closed, so that it has no inside: an odd number of faces "
                      "meets at 4 edges; close it, or set `where: near`");
    CHECK(NodeBench(mask_mesh(), "{where: near}").faults() ==
          "where: `where: near` needs a 'distance' above 0\n");
    CHECK(NodeBench(mask_mesh(), "{distance: 1}").faults() ==
          "distance: 'distance' is only for `where: near`\n");
}

TEST_CASE(
    "below the surfaces is all that is beneath the uppermost inside voxel of any of them, along "
    "any axis") {
    // Two level sets of one transform, a drop above a pool and a bank beside it, and a pool of
    // tiles alone.
    const auto level_set = [](const Vec3d& low, const Vec3d& high) {
        return mesh_distance(boxed(low, high), *voxels(0.5), 3, std::nullopt);
    };
    const auto pool = level_set(Vec3d(0.1, 0.1, -4.1), Vec3d(9.9, 9.9, 2.1)),
               drop = level_set(Vec3d(3.1, 3.1, 6.1), Vec3d(5.1, 5.1, 8.1));
    FloatGrid tiles(1);
    tiles.setTransform(voxels(0.5));
    tiles.setGridClass(openvdb::GRID_LEVEL_SET);
    tiles.tree().addTile(1, Coord(24, 8, 0), -1, true);
    tiles.tree().addTile(1, Coord(24, 8, 8), 0.5, true);
    const std::vector<Ref<FloatGrid>> surfaces{pool, drop, std::make_shared<FloatGrid>(tiles)};
    CoordBBox known, all(Coord(-40), Coord(60));
    for (const auto& surface : surfaces) {
        CoordBBox box;
        surface->tree().evalActiveVoxelBoundingBox(box);
        known.expand(box);
    }
    for (const auto& [up, axis, sign] :
         {std::tuple{Vec3d(0, 0, 2), 2, 1}, std::tuple{Vec3d(0, 0, -1), 2, -1},
          std::tuple{Vec3d(1, 0, 0), 0, 1}})
        for (const int depth : {0, 3}) {
            const auto mask = below_surface_mask(surfaces, up, 0.5 * depth);
            check_mask(*mask, known, [&, axis = axis, sign = sign](Coord voxel) {
                for (voxel[axis] += sign * depth; known.isInside(voxel); voxel[axis] += sign)
                    for (const auto& surface : surfaces)
                        if (surface->tree().getValue(voxel) < 0) return true;
                return false;
            });
        }
    CHECK(below_surface_mask({pool}, Vec3d(0, 0, 1), 0)->tree().getValueDepth(Coord(12, 12, -4)) <
          static_cast<int>(openvdb::MaskTree::DEPTH) - 1);
    CHECK_THROWS_WITH(below_surface_mask({pool}, Vec3d(0, 1, 1), 0),
                      "'up' (0, 1, 1) runs along no axis of the voxels of grid 'surface'; choose "
                      "one that does, or resample the grid");
    auto fog = pool->deepCopy();
    fog->setGridClass(openvdb::GRID_FOG_VOLUME);
    CHECK_THROWS_WITH(below_surface_mask({fog}, Vec3d(0, 0, 1), 0),
                      "grid 'surface' is a fog volume, which has no surface; connect a level set, "
                      "such as sdf.from_mesh makes");
    CHECK(below_surface_mask({FloatGrid::create()}, Vec3d(0, 0, 1), 0)->empty());
    CHECK(NodeBench(mask_below_surface(), "{up: [0, 0, 0]}").faults() ==
          "up: 'up' has no direction\n");
}

TEST_CASE(
    "a mesh with a place that is no number, and surfaces that reach to the ends of index space, "
    "are refused") {
    for (const int c : {0, 2}) {
        auto mesh = boxed(Vec3d(0), Vec3d(1));
        mesh.points[3][c] = std::nan("");
        CHECK_THROWS_WITH(mesh_distance(mesh, *voxels(1), 3, std::nullopt),
                          Catch::StartsWith("the mesh reaches nan voxels"));
    }
    const auto far = FloatGrid::create(3);
    far->setGridClass(openvdb::GRID_LEVEL_SET);
    far->setName("bank");
    far->tree().setValue(Coord(std::numeric_limits<int>::min(), 0, 0), -1);
    far->tree().setValue(Coord(std::numeric_limits<int>::max(), 0, 0), -1);
    CHECK_THROWS_WITH(
        below_surface_mask({far}, Vec3d(0, 0, 1), 0),
        Catch::StartsWith("the active voxels of grid 'bank' span [-2147483648, 0, 0]"));
}
