#include "carve/base/failure.h"
#include "carve/lattice/build.h"
#include "carve/lattice/extension_faults.h"
#include "carve/lattice/overlap.h"
#include "carve/rig/circle.h"
#include "nodes/lattice.h"
#include "tests/support/built_lattices.h"
#include "tests/support/node_bench.h"
#include "tests/support/scratch.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Vec3d;

namespace {

/// Two legs, `apart`, and half a circle between them; `u` points to its outside.
Rig hairpin_rig(double apart) {
    std::vector<Vec3d> points{{0, 0, 0}};
    for (int n = 0; n <= 100; ++n) {
        const double a = M_PI * n / 100;
        points.push_back({8 + 0.5 * apart * std::sin(a), 0.5 * apart * (std::cos(a) - 1), 0});
    }
    points.push_back({0, -apart, 0});
    return through(points);
}

}  // namespace

TEST_CASE("voxels in several cells are those that are found there one by one, slab by slab") {
    const auto cubes = openvdb::math::Transform::createLinearTransform(0.11);
    const auto counted = [&](const Lattice& lattice, const std::array<int, 3>& extent) {
        const Mapping mapping(lattice, extent);
        const auto& slabs = *mapping.slabs();
        const auto box = cubes->worldToIndex(
            mapping.world_box({Vec3d(0), Vec3d(extent[0] - 1, extent[1] - 1, slabs.size())}));
        std::size_t shared = 0;
        std::vector<std::size_t> lowest(static_cast<std::size_t>(slabs.size()));
        for (auto at = openvdb::CoordBBox(openvdb::Coord::floor(box.min()),
                                          openvdb::Coord::ceil(box.max()))
                           .begin();
             at; ++at) {
            const auto p = cubes->indexToWorld(*at);
            int cells = 0, first = 0;
            for (int k = 0; k < slabs.size(); ++k) {
                if (!(slabs.divider(k).side(p) >= 0 && slabs.divider(k + 1).side(p) < 0)) continue;
                Vec3d place;
                if (slabs.settle(k,
                                 slabs[k].solve(slabs[k].products(p), slabs.from(k), slabs.to(k)),
                                 place) == Slabs::Holds::no)
                    continue;
                if (++cells == 1) first = k;
                if (cells == 2) ++lowest[static_cast<std::size_t>(first)];
            }
            shared += cells > 1 ? 1 : 0;
        }
        const auto overlap = count_overlap(mapping, *cubes);
        CHECK(overlap.voxels == shared);
        if (shared > 0) CHECK(overlap.plane == std::ranges::max_element(lowest) - lowest.begin());
        return shared;
    };
    const auto built = [](const Rig& rig, const LatticeSpec& spec) {
        return build_lattice(rig, spec).lattice;
    };
    auto kinked = spec(0.2);
    kinked.smooth = Smooth::none;
    const auto wide = spec(0.2, {-0.6, 0.6}, {-0.6, 0.6});
    for (const auto& [lattice, meets] :
         {std::pair(built(through(helix_points()), spec(0.2)), false),
          std::pair(built(through(helix_points(0.1)), spec(0.2)), true),
          std::pair(built(through(saddle_points(), true), wide), false),
          std::pair(built(circle_rig({0, 0, 0}, {0, 0, 1}, {1, 1}, 0), wide), false),
          std::pair(built(hairpin_rig(2), spec(0.2)), false),
          std::pair(built(hairpin_rig(2), spec(0.2, {-1.3, 0.5})), true),
          std::pair(built(through({{0, 0, 0}, {4, 0, 0}, {2, 3, 0}}), kinked), true)}) {
        INFO(lattice.description);
        CHECK((counted(lattice, lattice.shape) > 0) == meets);
    }
    const auto legs = built(hairpin_rig(2), spec(0.2, {-0.8, 0.5}));
    CHECK(counted(legs, legs.shape) == 0);
    auto flipped = spec(0.2, {-0.5, 0.8});
    flipped.flip_u = true;
    const auto inwards = built(hairpin_rig(2), flipped);
    CHECK(counted(inwards, {inwards.shape[0] + 3, inwards.shape[1], inwards.shape[2]}) > 0);
}

TEST_CASE(
    "insertions that make a sound lattice fold or meet itself are told with the worst frame") {
    auto inwards = spec(0.2, {-0.5, 0.5});
    inwards.flip_u = true;
    const auto legs = [&](double apart) {
        return build_lattice(hairpin_rig(apart), inwards).lattice;
    };
    ExtensionFaults sound;
    sound.add(legs(2), Axis::u, 0, 0, 1);
    sound.add(legs(2), Axis::u, 0, 2, 1);
    sound.add(legs(2), Axis::v, 0, 40, 1);
    CHECK(sound.fault().empty());

    ExtensionFaults one;
    one.add(legs(2), Axis::u, 0, 4, 1);
    const auto lattice = legs(2);
    auto extent = lattice.shape;
    extent[0] += 4;
    const auto folds = count_folds(lattice, extent[0], extent[1]);
    const auto overlap = count_overlap(Mapping(lattice, extent),
                                       *openvdb::math::Transform::createLinearTransform(0.2));
    REQUIRE(folds.cells > 0);
    REQUIRE(overlap.voxels > 0);
    const auto between = [&](int plane) {
        return fmt::format("most of them between planes {} and {}", plane, plane + 1);
    };
    CHECK(one.fault() ==
          fmt::format("to insert 4 seams, the lattice is extended beyond its last vertex along u, "
                      "and there {} cells are folded, {}, and {} voxels, as "
                      "large as the spacing, lie in several cells, {}: part of what is pushed "
                      "there is lost; insert fewer seams, or turn the lattice around "
                      "with its `flip_u` or its rig's `up`, so that it grows to the other side",
                      folds.cells, between(folds.plane), overlap.voxels, between(overlap.plane)));
    ExtensionFaults moving;
    for (const auto& [frame, apart] : {std::pair(1, 4.0), std::pair(2, 2.0), std::pair(3, 3.0)})
        moving.add(legs(apart), Axis::u, 0, 4, frame);
    CHECK(moving.fault().find(fmt::format("{} cells are folded in frame 2, ", folds.cells)) !=
          std::string::npos);
    CHECK(moving.fault().find(
              fmt::format("{} voxels, as large as the spacing, lie in several cells in frame 2, ",
                          overlap.voxels)) != std::string::npos);
}

TEST_CASE("lattice.build tells where a lattice meets itself, in the worst frame") {
    // More than a turn of a circle: nothing is folded.
    const auto turned = [](double degrees) {
        std::vector<Vec3d> points;
        for (double a = 0; a <= degrees; ++a)
            points.push_back({2 * std::cos(a * M_PI / 180), 2 * std::sin(a * M_PI / 180), 0});
        return through(points);
    };
    const std::string around = "spacing: 0.2, extent_u: [-0.5, 0.5], extent_v: [-0.4, 0.4]";
    const Run run("{" + around + "}", {turned(380), turned(440), turned(400)}, {4, 5, 6});
    REQUIRE(run.heard.warnings.size() == 2);
    const auto overlap = count_overlap(Mapping(*run.lattices[1]),
                                       *openvdb::math::Transform::createLinearTransform(0.2));
    REQUIRE(overlap.voxels > 100);
    const auto message = [&](const std::string& frame) {
        return fmt::format(
            "{} voxels, as large as the spacing, lie in several cells{}, most of them between "
            "planes {} and {}, since the lattice overlaps itself; each is "
            "carved only in the cell of the lowest plane: reduce the extents, or keep the parts of "
            "the rig further apart",
            overlap.voxels, frame, overlap.plane, overlap.plane + 1);
    };
    CHECK(run.heard.warnings[1] == message(" in frame 5"));
    CHECK(run.heard.reported.at("lattices").at("shared_voxels") == overlap.voxels);
    CHECK(Run("{" + around + "}", {turned(350)}).heard.warnings.empty());
    CHECK(failure_of([&] { Run("{" + around + ", on_fold: error}", {turned(440)}); }) ==
          message(""));
}

TEST_CASE("lattice.build says before a run what is wrong with its extents and spacing") {
    const auto faults = [](const std::string& yaml) {
        return NodeBench(lattice_build(), yaml, {{"rig", 1}}).faults();
    };
    CHECK(faults("{spacing: 0, extent_u: [0, 1], extent_v: [0, 1]}") ==
          "spacing: 'spacing' must be above 0\n");
    CHECK(faults("{spacing: 0.1, extent_u: [0, 0], extent_v: [1, 1]}") ==
          "extent_u: 'extent_u' is [0, 0], which is empty; for a single vertex, as for images, "
          "state less than one spacing: [0, 0.05]\n"
          "extent_v: 'extent_v' is [1, 1], which is empty; for a single vertex, as for images, "
          "state less than one spacing: [1, 1.05]\n");
    CHECK(faults("{spacing: 0.1, extent_u: [0, 10000], extent_v: [0, 1]}") ==
          "extent_u: 'extent_u' holds 100001 vertices at a spacing of 0.1; 65534 is the most\n");
}

TEST_CASE("lattices say before a run where they will lie") {
    const Region line{{{{0, 0, 0}, {9, 0, 0}}}, {{"otherwise", {{{0, 0, 0}, {0, 9, 0}}}}}};
    const auto built = *NodeBench(lattice_build(),
                                  "{spacing: 1, extent_u: [-3, 1], extent_v: [0, 4]}", {{"rig", 1}})
                            .foresee({{"rig", line}})
                            .outputs;
    CHECK(to_text(built.boxes.at(0)) == "(-5, -5, -5) to (14, 5, 5)");
    CHECK(to_text(built.otherwise.at(0).boxes.at(0)) == "(-5, -5, -5) to (5, 14, 5)");
    const auto stated =
        *NodeBench(lattice_box(), "{min: [0, 1, 2], max: [3, 4, 5], spacing: 1}").foresee().outputs;
    CHECK(to_text(stated.boxes.at(0)) == "(0, 1, 2) to (3, 4, 5)");
    NodeBench fitted(lattice_box(), "{}", {{"fit", 1}});
    CHECK(to_text(fitted.foresee({{"fit", line}}).outputs->boxes.at(0)) ==
          "(0, 0, 0) to (9, 0, 0)");
    CHECK(!fitted.foresee().outputs);
}

TEST_CASE("lattices say before a run how many vertices they will have") {
    const auto shape = [](NodeType type, const std::string& yaml,
                          const std::map<std::string, std::size_t>& connected) {
        const auto told = NodeBench(std::move(type), yaml, connected).foresee().facts;
        std::array<int, 3> out{};
        for (const auto& [at, name] : {std::pair(0, "u"), std::pair(1, "v"), std::pair(2, "w")})
            if (const auto found = told.find(name); found != told.end())
                out[static_cast<std::size_t>(at)] = found->second;
        return out;
    };
    CHECK(shape(lattice_build(), "{spacing: 0.1, extent_u: [-1, 1], extent_v: [0, 0.05]}",
                {{"rig", 1}}) == std::array{21, 1, 0});
    CHECK(shape(lattice_around(), "{spacing: 1, radius: 4.5}", {{"rig", 1}}) ==
          std::array{5, 25, 0});
    CHECK(shape(lattice_box(), "{min: [0, 1, 2], max: [3, 5, 7], spacing: 1, axes: zxy}", {}) ==
          std::array{6, 4, 5});
    CHECK(shape(lattice_box(), "{}", {{"fit", 1}}) == std::array{0, 0, 0});
}

TEST_CASE("lattice.build delivers a static rig's lattice once, and reports it") {
    const Run run("{spacing: 0.1, extent_u: [-0.8, 0.8], extent_v: [-0.4, 0.4]}",
                  {circle_rig({0, 0, 0}, {0, 0, 1}, {5, 5}, 0)});
    CHECK(run.heard.warnings.empty());
    CHECK(run.lattices[0]->shape == std::array{17, 9, 314});
    const auto& entry = run.heard.reported.at("lattices");
    CHECK(entry.at("shape") == nlohmann::ordered_json{17, 9, 314});
    CHECK(entry.at("closed") == true);
    CHECK(entry.at("spacing") == 0.1);
    CHECK(entry.at("step").at(0).get<double>() == Approx(10 * std::sin(M_PI / 314)));
    CHECK(entry.at("folded_cells") == 0);
    CHECK(entry.at("shared_voxels") == 0);
    CHECK(entry.at("smoothed") == 0);
    CHECK(entry.at("moved") == 0);
}

TEST_CASE("lattice.build gives all frames of a moving rig the planes of the longest") {
    const Run run("{spacing: 0.5, extent_u: [-1, 1], extent_v: [-1, 1]}",
                  {through({{0, 0, 0}, {4, 0, 0}}), through({{0, 0, 0}, {0, 8, 0}}),
                   through({{0, 0, 0}, {0, 0.1, 0}, {0, 8.2, 0}})},
                  {5, 7, 9});
    CHECK(
        run.heard.warnings ==
        std::vector<std::string>{"the rig needs 17 planes in frame 7, but 9 in frame 5; all frames "
                                 "get 17 planes, which are 0.25 apart in frame 5 instead of 0.5"});
    for (const auto& lattice : run.lattices) CHECK(lattice->shape == std::array{5, 5, 17});
    CHECK((run.lattices[0]->position(Vec3d(2, 2, 16)) - Vec3d(4, 0, 0)).length() < 1e-9);
    CHECK((run.lattices[1]->position(Vec3d(2, 2, 16)) - Vec3d(0, 8, 0)).length() < 1e-9);
    CHECK((run.lattices[2]->position(Vec3d(2, 2, 16)) - Vec3d(0, 8, 0)).length() < 1e-9);
    CHECK(run.lattices[0]->hash != run.lattices[1]->hash);

    const auto square = std::vector<Vec3d>{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}};
    CHECK(failure_of([&] {
              Run("{spacing: 0.5, extent_u: [-0.1, 0.1], extent_v: [-1, 1]}",
                  {through(square), through(square, true)}, {5, 6});
          }) == "the rig is open in frame 5, but closed in frame 6");
}

TEST_CASE("lattice.build tells of folds and of smoothing against them, where they are worst") {
    const auto straight = through({{0, 0, 0}, {8, 0, 0}}),
               kinked = through({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}});
    const std::string extents = "spacing: 0.5, extent_u: [-1, 1], extent_v: [-1, 1]";
    const Run folded("{" + extents + ", smooth: none}", {straight, kinked}, {1, 2});
    CHECK(folded.heard.warnings ==
          std::vector<std::string>{"12 cells are folded in frame 2, most of them (8) between "
                                   "planes 8 and 9: reduce the extents on the "
                                   "inner side of the bend, or smooth the rig more"});
    CHECK(failure_of([&] { Run("{" + extents + ", smooth: none, on_fold: error}", {kinked}); }) ==
          "12 cells are folded, most of them (8) between planes 8 and 9: reduce the extents on the "
          "inner side of the bend, or smooth the rig more");
    const Run smoothed("{" + extents + "}", {kinked});
    REQUIRE(smoothed.heard.warnings.size() == 1);
    CHECK(smoothed.heard.warnings[0] ==
          "the rig was smoothed 4 times to avoid folded cells, which moved it by up to 0.4539");
    CHECK(smoothed.heard.reported.at("lattices").at("moved").get<double>() ==
          Approx(0.4539).epsilon(1e-4));
    // Less than half a spacing goes without saying.
    const Run rounded("{spacing: 0.5, extent_u: [-5, 5], extent_v: [-1, 1]}",
                      {through({{0, 0, 0}, {4, 0, 0}, {8, 1, 0}})});
    CHECK(rounded.heard.warnings.empty());
    CHECK(rounded.heard.reported.at("lattices").at("smoothed") > 0);
    CHECK(rounded.heard.reported.at("lattices").at("moved") > 0);
}

TEST_CASE("lattice.build says at once that no smoothing cures a circle that is reached across") {
    const auto circle = circle_rig({0, 0, 0}, {0, 0, 1}, {1, 1}, 0);
    const Run run("{spacing: 0.1, extent_u: [-1.25, 0.5], extent_v: [-0.1, 0.1]}", {circle});
    CHECK(
        run.heard.warnings ==
        std::vector<std::string>{"378 cells are folded, most of them (6) between planes 0 and 1: "
                                 "the lattice reaches 1.25 inwards, past the centre of a circle of "
                                 "radius 1 around (0, 0, 0), and no smoothing repairs that: keep "
                                 "'extent_u' within the radius"});
    CHECK(failure_of([&] {
              Run("{spacing: 0.1, extent_u: [-0.5, 1.2], extent_v: [-0.1, 0.1], flip_u: true, "
                  "on_fold: error}",
                  {circle});
          }).find("reaches 1.2 inwards") != std::string::npos);
}

TEST_CASE("lattice.write draws the lines of a lattice, closed where it is") {
    const Scratch folder;
    struct Drawn {
        std::vector<Vec3d> vertices;
        std::vector<std::vector<std::size_t>> lines;
        std::string head;
        explicit Drawn(const std::string& path) {
            std::istringstream in(Scratch::read(path));
            std::getline(in, head);
            for (std::string line; std::getline(in, line);) {
                std::istringstream words(line);
                std::string kind;
                words >> kind;
                if (kind == "v") {
                    vertices.emplace_back();
                    words >> vertices.back().x() >> vertices.back().y() >> vertices.back().z();
                } else {
                    REQUIRE(kind == "l");
                    lines.emplace_back();
                    for (std::size_t n; words >> n;) lines.back().push_back(n - 1);
                }
            }
        }
    };
    const auto write = [&](const std::string& name, const Lattice& lattice,
                           const std::string& more) {
        const auto path = folder / name;
        NodeBench(lattice_write(), "{path: " + path + more + "}")
            .run({{"lattice", {Payload(std::make_shared<Lattice>(lattice))}}});
        return Drawn(path);
    };
    const auto box = make_box(Vec3d(1, 2, 3), {4, 3, 1}, 0.5, {0, 1, 2});
    const auto all = write("box.obj", box, ", every: 1");
    CHECK(all.head == "# " + box.description);
    REQUIRE(all.vertices.size() == 12);
    CHECK(all.vertices[0] == Vec3d(1, 2, 3));
    CHECK(all.vertices[11] == Vec3d(2.5, 3, 3));
    // Each line has two vertices: Blender would read no more of a longer one.
    CHECK(all.lines.size() == 3 * 3 + 2 * 4);
    for (const auto& line : all.lines) REQUIRE(line.size() == 2);
    CHECK(all.lines[0] == std::vector<std::size_t>{0, 1});
    CHECK(all.lines[2] == std::vector<std::size_t>{2, 3});
    CHECK(all.lines[3] == std::vector<std::size_t>{4, 5});
    CHECK(std::set(all.lines.begin() + 9, all.lines.end()) ==
          std::set<std::vector<std::size_t>>{
              {0, 4}, {4, 8}, {1, 5}, {5, 9}, {2, 6}, {6, 10}, {3, 7}, {7, 11}});
    const auto some = write("some.obj", box, ", every: 2");
    CHECK(some.vertices ==
          std::vector<Vec3d>{{1, 2, 3}, {2, 2, 3}, {2.5, 2, 3}, {1, 3, 3}, {2, 3, 3}, {2.5, 3, 3}});

    const auto ring = build_lattice(circle_rig({0, 0, 0}, {0, 0, 1}, {5, 5}, 0), spec(0.1)).lattice;
    const auto drawn = write("ring.obj", ring, "");
    CHECK(drawn.vertices.size() == 11 * 11 * 17);
    for (const auto& vertex : drawn.vertices)
        REQUIRE(std::abs(std::hypot(vertex.x(), vertex.y()) - 5) < 0.5 + 1e-6);
    // 10 edges along u and along v, 17 around: the last plane is joined to the first.
    REQUIRE(drawn.lines.size() == 10 * 11 * 17 + 10 * 11 * 17 + 17 * 11 * 11);
    std::size_t closing = 0;
    for (const auto& line : drawn.lines) closing += line[0] == line[1] + 11 * 11 * 16 ? 1 : 0;
    CHECK(closing == 11 * 11);
}
