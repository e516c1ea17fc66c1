#include "carve/remap/geometry/mesh.h"
#include "carve/remap/grid.h"
#include "carve/sdf/from_mesh.h"
#include "carve/sdf/to_mesh.h"
#include "carve/seam/carve_inverse.h"
#include "nodes/remap.h"
#include "tests/support/bent_lattices.h"
#include "tests/support/node_bench.h"
#include "tests/support/reference_carve.h"
#include "tests/support/wavy_seams.h"

#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <catch2/catch.hpp>

#include <cmath>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Vec3d;
using Kind = Seams::Kind;

namespace {

Lattice box_lattice(const std::array<int, 3>& shape, double spacing = 1,
                    const Vec3d& first = Vec3d(0)) {
    return make_box(first, shape, spacing, {0, 1, 2});
}

CarveMap map_of_all(const Lattice& lattice, const std::vector<Seams>& sets, double fade = 0) {
    auto out = map_of(lattice, sets);
    if (fade > 0) out.fade_rims(fade);
    return out;
}

/// `M` of METHOD 4 for one set, straight from its definition: the entries that are left are listed,
/// and read between.
class Forward {
public:
    Forward(const Lattice& lattice, const Seams& seams) : lattice_(lattice), seams_(seams) {}

    /// The original coordinate of a point of the carved space.
    double operator()(const Vec3d& carved) const {
        const auto along = [&](std::size_t n) { return carved[static_cast<int>(n)]; };
        const double u = along(dimension(seams_.axis)),
                     lateral = along(lateral_dimension(seams_.axis)),
                     slice = along(slice_dimension(seams_.axis));
        const int j = static_cast<int>(std::floor(lateral)),
                  k = static_cast<int>(std::floor(slice));
        const double b = lateral - j, c = slice - k;
        double out = 0;
        for (int n = 0; n < 4; ++n) {
            const double weight = (n & 1 ? b : 1 - b) * (n & 2 ? c : 1 - c);
            if (weight == 0) continue;
            const auto left =
                entries(j + (n & 1),
                        (k + (n >> 1)) % (lattice_.closed ? seams_.slices() : seams_.slices() + 1));
            const auto i = std::min(static_cast<std::size_t>(u), left.size() - 2);
            const double a = u - static_cast<double>(i);
            out += weight * ((1 - a) * left[i] + a * left[i + 1]);
        }
        return out;
    }
    int size() const { return static_cast<int>(entries(0, 0).size()); }

private:
    std::vector<double> entries(int lateral, int k) const {
        std::vector<double> left, doubled;
        for (int i = 0; i < seams_.before(); ++i) left.push_back(i);
        const auto column = static_cast<std::size_t>(lateral + seams_.laterals() * k);
        const auto take = [&](const std::vector<Seams::Seam>& window, Kind kind) {
            for (const auto& seam : window) {
                if (kind == Kind::remove) left.erase(left.begin() + seam.at[column]);
                else doubled.push_back(seam.at[column] + 0.5);
            }
        };
        take(seams_.seams, seams_.kind);
        take(seams_.pairs, opposite(seams_.kind));
        left.insert(left.end(), doubled.begin(), doubled.end());
        std::ranges::sort(left);
        return left;
    }
    const Lattice& lattice_;
    const Seams& seams_;
};

Mesh sheet(int edge, double spacing, const Vec3d& first) {
    Mesh out;
    for (int y = 0; y < edge; ++y)
        for (int x = 0; x < edge; ++x)
            out.points.push_back(first + Vec3d(spacing * x, spacing * y, 0));
    const auto at = [&](int x, int y) { return static_cast<std::uint32_t>(x + edge * y); };
    for (int y = 0; y + 1 < edge; ++y)
        for (int x = 0; x + 1 < edge; ++x)
            out.add_face(std::array{at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)});
    return out;
}

}  // namespace

TEST_CASE(
    "the inverse of a carve undoes it, to the last digits, and rises along the axis, for any "
    "seams") {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int round = 0; round < 60; ++round) {
        const bool closed = round % 3 == 0;
        const auto axis = !closed && round % 4 == 1 ? Axis::w : round % 2 ? Axis::u : Axis::v;
        auto lattice = box_lattice({12, 12, axis == Axis::w ? 12 : 7});
        if (closed) lattice = ring(Vec3d(0), {12, 12, 24}, 0.5, {1, 0});
        const auto kind = round % 4 < 2 ? Kind::remove : Kind::insert;
        const int count = 1 + below(random, 3);
        const auto seams =
            round % 5 == 4 ? random_pairs(random, lattice, lattice.shape, axis, kind, count, {1})
                           : random_seams(random, lattice, lattice.shape, axis, kind, count, {1});
        const auto map = map_of(lattice, {seams});
        const auto& step = map.steps().at(0);
        const Forward forward(lattice, seams);
        REQUIRE(forward.size() == step.after());
        for (int n = 0; n < 40; ++n) {
            Vec3d at(unit(random) * 11, unit(random) * 11,
                     unit(random) * (lattice.shape[2] - (closed ? 0 : 1)));
            const int b = static_cast<int>(lateral_dimension(axis)),
                      c = static_cast<int>(slice_dimension(axis));
            if (n % 4 == 0) at[c] = std::floor(at[c]);
            if (n % 3 == 0) at[b] = std::floor(at[b]);
            const int a = static_cast<int>(axis);
            auto first = at, last = at;
            first[a] = 0;
            last[a] = step.after() - 1;
            double before = -1;
            for (double u = 0; u <= 11; u += 0.25) {
                auto from = at;
                from[a] = u;
                auto to = from;
                to[a] = carved_coordinate(step, from);
                REQUIRE(to[a] >= before);
                before = to[a];
                // What is taken at an end goes to the end.
                const double expected = std::clamp(u, forward(first), forward(last));
                REQUIRE(forward(to) == Approx(expected).margin(1e-9));
                REQUIRE((to[a] >= 0 && to[a] <= step.after() - 1));
                CHECK(carved_coordinates(map, from) == to);
            }
        }
    }
}

TEST_CASE("with a fade the inverse is that of the faded carve") {
    const auto lattice = box_lattice({14, 14, 14});
    for (const auto kind : {Kind::remove, Kind::insert}) {
        const auto seams = wavy_seams(lattice, Axis::u, kind, 6, 3, 1);
        const auto map = map_of_all(lattice, {seams}, 4);
        const auto& step = map.steps().at(0);
        const Forward forward(lattice, seams);
        for (const double v : {0.0, 0.5, 2.0, 3.25, 7.0, 12.0})
            for (double u = 0; u <= 13; u += 0.2) {
                const Vec3d at(u, v, 6.5);
                const double scale = step.rim_scale(at), to = carved_coordinate(step, at),
                             end = step.ends(at, scale).end;
                CHECK(to <= end + 1e-12);
                if (scale == 0) CHECK(to == u);
                // Beyond the last entry of a removal all is displaced alike.
                const double last = step.after() - 1,
                             source = forward(Vec3d(std::min(to, last), v, 6.5)) +
                                      std::max(0.0, to - last);
                const double lowest = scale * forward(Vec3d(0, v, 6.5)),
                             drawn = to + scale * (source - to);
                if (to < end - 1e-9) CHECK(drawn == Approx(std::max(u, lowest)).margin(1e-9));
            }
    }
}

TEST_CASE(
    "a straight seam moves what is beyond it by a vertex, and a vertex right on it goes half way") {
    const auto lattice = box_lattice({10, 6, 6}, 0.5, Vec3d(1, 2, 3));
    const auto map = map_of(lattice, {straight_seams(lattice, Axis::u, Kind::remove, {4})});
    Mesh mesh;
    const std::vector<std::pair<double, double>> ways{{0, 0},      {3, 3}, {3.5, 3.25},  {4, 3.5},
                                                      {4.5, 3.75}, {5, 4}, {8.25, 7.25}, {9, 8}};
    for (const auto& [from, to] : ways)
        mesh.points.push_back(Vec3d(1, 2, 3) + 0.5 * Vec3d(from, 2.5, 1));
    mesh.points.emplace_back(1 + 0.5 * 9.5, 3, 3.5);  // beyond the lattice, alone
    const auto carved = carve_mesh(mesh, lattice, map).mesh;
    for (std::size_t n = 0; n < ways.size(); ++n)
        CHECK((carved.points[n] - (Vec3d(1, 2, 3) + 0.5 * Vec3d(ways[n].second, 2.5, 1))).length() <
              1e-12);
    CHECK(carved.points[0] == mesh.points[0]);
    CHECK(carved.points[1] == mesh.points[1]);
    CHECK(carved.points.back() == mesh.points.back());
}

TEST_CASE("chains of carves move vertices first carve first, as sets found after one another do") {
    std::mt19937 random(3);
    const auto lattice = box_lattice({12, 10, 6});
    const auto one = random_seams(random, lattice, {12, 10, 6}, Axis::u, Kind::remove, 2, {1});
    const auto two = random_seams(random, lattice, {10, 10, 6}, Axis::v, Kind::insert, 3, {1});
    const auto three = random_pairs(random, lattice, {10, 13, 6}, Axis::u, Kind::insert, 2, {1});
    const auto map = map_of(lattice, {one, two, three});
    const Forward first(lattice, one), second(lattice, two), third(lattice, three);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int n = 0; n < 500; ++n) {
        const Vec3d from(1 + 8 * unit(random), 9 * unit(random), 5 * unit(random));
        auto back = carved_coordinates(map, from);
        back[0] = third(back);
        back[1] = second(back);
        back[0] = first(back);
        // The ends, where a removal may take the outermost entry, are left out.
        if (back[0] > 0.5 && back[0] < 10.5 && from[0] > 2.5 && from[0] < 8.5)
            CHECK((back - from).length() < 1e-9);
    }
}

TEST_CASE(
    "vertices beside the lattice, or where nothing moves, are the same to the last bit, and a set "
    "without seams is the mesh itself") {
    const auto lattice = ring(Vec3d(0), {10, 8, 40}, 0.1, {0.2, 0});
    auto seams = straight_seams(lattice, Axis::u, Kind::remove, {6, 6});
    Mesh mesh;
    std::mt19937 random(9);
    std::uniform_real_distribution<double> unit(-2, 2);
    for (int n = 0; n < 2000; ++n)
        mesh.points.emplace_back(unit(random), unit(random), 0.4 * unit(random));
    const Mapping mapping(lattice);
    const auto carved = carve_mesh(mesh, lattice, map_of(lattice, {seams})).mesh;
    int inside = 0;
    for (std::size_t n = 0; n < mesh.points.size(); ++n) {
        const auto at = mapping.locate(mesh.points[n]);
        inside += at && at->x() > 5;
        if (!at || at->x() <= 5) CHECK(carved.points[n] == mesh.points[n]);
        else CHECK(carved.points[n] != mesh.points[n]);
    }
    CHECK(inside > 30);

    seams.seams.clear();
    NodeBench bench(remap_mesh());
    const auto source = std::make_shared<const Mesh>(mesh);
    const auto out = bench.run({{"source", {Payload(source)}},
                                {"lattice", {Payload(std::make_shared<Lattice>(lattice))}},
                                {"seams", {Payload(std::make_shared<Seams>(seams))}}});
    CHECK(out.at("mesh").as<Mesh>() == source);
}

TEST_CASE("pairs move what is between their windows and nothing beyond") {
    const auto lattice = box_lattice({20, 6, 6});
    auto seams = straight_seams(lattice, Axis::u, Kind::remove, {4, 4});
    for (const int entry : {14, 15}) seams.pairs.push_back(straight_seam(seams, entry));
    const auto map = map_of(lattice, {seams});
    for (const double u : {0.0, 2.9, 3.0, 17.0, 18.5, 19.0})
        CHECK(carved_coordinate(map.steps().at(0), Vec3d(u, 2.2, 3.1)) == u);
    for (const double u : {6.0, 10.5, 14.0})
        CHECK(carved_coordinate(map.steps().at(0), Vec3d(u, 2.2, 3.1)) == Approx(u - 2));
}

TEST_CASE(
    "faces and attributes stay, and seams that change make a mesh of one file one per frame") {
    const auto lattice = box_lattice({10, 10, 4});
    auto seams = straight_seams(lattice, Axis::u, Kind::remove, {5}, {1, 2});
    for (std::size_t c = seams.columns_per_frame(); c < 2 * seams.columns_per_frame(); ++c)
        seams.seams[0].at.all()[c] = 4;
    auto mesh = sheet(8, 1, Vec3d(1, 1, 1));
    mesh.attributes.push_back({"uv",
                               Mesh::Attribute::On::vertices,
                               {"s", "t"},
                               Mesh::Attribute::Type::float64,
                               std::vector<double>(128, 0.5),
                               {}});
    const NodeBench::Inputs inputs{{"source", {Payload(std::make_shared<Mesh>(mesh))}},
                                   {"lattice", {Payload(std::make_shared<Lattice>(lattice))}},
                                   {"seams", {Payload(std::make_shared<Seams>(seams))}}};
    NodeBench bench(remap_mesh());
    Context::Host host;
    const std::vector<int> frames{1, 2};
    const auto first = bench.run(inputs, Context(host, frames).at(0)).at("mesh").as<Mesh>();
    const auto second = bench.run(inputs, Context(host, frames).at(1)).at("mesh").as<Mesh>();
    CHECK(first->corners == mesh.corners);
    CHECK(first->ends == mesh.ends);
    CHECK(first->attributes.at(0).values == mesh.attributes[0].values);
    CHECK(first->points[3] == Vec3d(4, 1, 1));
    CHECK(second->points[3] == Vec3d(3.5, 1, 1));

    const auto moves = [](const std::string& yaml) {
        const NodeType type = remap_mesh();
        NodeBench checked(type, yaml);
        REQUIRE(checked.faults().empty());
        return type.traits(type.make_params().get()).animates == true;
    };
    CHECK(moves("{}"));
    // One mesh for all frames can't follow them, unless they move it alike, as all that lies beyond
    // them.
    NodeBench still(remap_mesh(), "{static: true}");
    CHECK_THROWS_WITH(
        still.run(inputs, Context(host, frames)),
        "the mesh is one file for all frames, but seams move vertex 3 (counted from 0) differently "
        "in frame 2 than in frame 1; leave `static` "
        "out to get one mesh per frame, or `protect` the mesh from seams with a mask.mesh");
    auto beyond = inputs;
    auto far = sheet(3, 1, Vec3d(6, 1, 1));
    beyond["source"] = {Payload(std::make_shared<Mesh>(far))};
    const auto moved = still.run(beyond, Context(host, frames)).at("mesh").as<Mesh>();
    for (std::size_t n = 0; n < far.points.size(); ++n)
        CHECK(moved->points[n] == far.points[n] - Vec3d(1, 0, 0));
    CHECK(NodeBench(remap_mesh(), "{rim_fade: 3}").faults() ==
          "rim_fade: nothing fades while `rim` is cut; set `rim: fade`, or leave `rim_fade` out\n");
}

TEST_CASE("long edges over a seam and faces across a rim are counted and told") {
    const auto lattice = box_lattice({20, 10, 10});
    const auto map = map_of(lattice, {straight_seams(lattice, Axis::u, Kind::remove, {7, 7, 7})});
    // Sheets of 4 x 4 faces: fine, coarse, and one that reaches beyond the rim v = 0.
    CHECK(warnings_of(carve_mesh(sheet(5, 1, Vec3d(5, 3, 5)), lattice, map)).empty());
    const auto coarse = carve_mesh(sheet(3, 4, Vec3d(6, 1, 5)), lattice, map);
    CHECK(coarse.stretched.worst == 4);
    // Two of the four faces, with two of their edges each.
    CHECK(coarse.stretched.share == Approx(4.0 / 16));
    CHECK(coarse.torn.share == 0);
    CHECK(warnings_of(coarse) ==
          std::vector<std::string>{
              "more than 10 % of the edges cross a seam and are longer than two vertices of the "
              "lattice, the "
              "longest 4: they stay straight where space bends; subdivide the mesh there"});
    const auto torn = carve_mesh(sheet(5, 1, Vec3d(12, -2, 5)), lattice, map);
    CHECK(torn.torn.share == Approx(4.0 / 16));
    CHECK(torn.torn.worst == 3);
    CHECK(warnings_of(torn).size() == 1);
    CHECK(warnings_of(torn).at(0).find("by 3 vertices at most") != std::string::npos);
    // A fade carves the rim itself not at all.
    CHECK(carve_mesh(sheet(5, 1, Vec3d(12, -2, 5)), lattice,
                     map_of_all(lattice, {straight_seams(lattice, Axis::u, Kind::remove, {8})}, 3))
              .torn.share == 0);
}

TEST_CASE("a carved mesh and a carved level set agree away from the seams, in a bent lattice too") {
    // The mesh of a ball, carved, as a level set; and the ball's level set, carved.
    const auto lattice = ring(Vec3d(0), {40, 40, 60}, 0.1, {-1.5, -2});
    const auto ball = openvdb::tools::createLevelSetSphere<FloatGrid>(
        0.9f, openvdb::Vec3f(1.3f, 0.2f, 0), 0.05f, 4);
    const auto seams = wavy_seams(lattice, Axis::u, Kind::remove, 12, 4, 1);
    const auto map = map_of(lattice, {seams});
    const auto direct = carve_mesh(surface_mesh(*ball, 0, 0), lattice, map);
    const auto grid =
        openvdb::GridBase::grid<FloatGrid>(carve_grid(ball, lattice, map, Interpolation::linear));
    const auto again = mesh_distance(direct.mesh, ball->transform(), 4, std::nullopt);
    REQUIRE(again->getGridClass() == openvdb::GRID_LEVEL_SET);
    const Mapping mapping(lattice);
    double sum = 0, other = 0;
    int count = 0;
    const auto uncarved = ball->getConstAccessor();
    const auto theirs = grid->getConstAccessor();
    for (auto voxel = again->cbeginValueOn(); voxel; ++voxel) {
        const auto at = mapping.locate(again->indexToWorld(voxel.getCoord()));
        if (!at || std::abs(*voxel) > 0.05 || (at->x() > 8 && at->x() < 16)) continue;
        sum += std::abs(*voxel - theirs.getValue(voxel.getCoord()));
        other += std::abs(*voxel - uncarved.getValue(voxel.getCoord()));
        ++count;
    }
    REQUIRE(count > 1000);
    CHECK(sum / count < 0.25 * 0.05);
    CHECK(other / count > 0.5 * 0.05);
}

TEST_CASE("a carved mesh is the same for any number of threads") {
    const auto lattice = ring(Vec3d(0), {40, 40, 60}, 0.1, {-1.5, -2});
    const auto map = map_of(lattice, {wavy_seams(lattice, Axis::u, Kind::insert, 20, 4, 1)});
    const auto mesh = sheet(100, 0.03, Vec3d(-1.5, -1.5, 0.2));
    const auto many = carve_mesh(mesh, lattice, map).mesh.points;
    tbb::task_arena arena(1);
    CHECK(arena.execute([&] { return carve_mesh(mesh, lattice, map).mesh.points; }) == many);
}
