#include "carve/remap/geometry/points.h"
#include "carve/remap/grid.h"
#include "formats/points_file/points_file.h"
#include "nodes/remap.h"
#include "tests/nodes/remap/remap_points_cases.h"
#include "tests/support/bent_lattices.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/node_bench.h"
#include "tests/support/point_lists.h"
#include "tests/support/reference_carve.h"
#include "tests/support/wavy_seams.h"

#include <tbb/task_arena.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <map>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::BBoxd;
using openvdb::Vec2d;
using openvdb::Vec3d;

TEST_CASE("copies stand off by their point's id alone, and by no more than the jitter") {
    const auto map = map_of(points_box, {straight_seams(points_box, Axis::u, Kind::insert, {10})});
    auto positions = scattered(BBoxd(Vec3d(10.05, 2, 2), Vec3d(10.95, 10, 11)), 500, 15);
    const auto identities = points_at(positions).identities();
    const auto copies = [&](const std::vector<Vec3d>& at, const std::vector<std::uint64_t>& ids,
                            double jitter) {
        std::map<std::uint64_t, Vec3d> out;
        for (const auto& image : carve_points(at, ids, points_box, map, jitter).images)
            if (image.moved) out[ids[image.source]] = image.position - at[image.source];
        return out;
    };
    const auto exact = copies(positions, identities, 0), off = copies(positions, identities, 0.25);
    REQUIRE(off.size() == 500);
    int far = 0;
    Vec3d mean(0);
    for (const auto& [id, by] : off) {
        REQUIRE((exact.at(id) - Vec3d(1, 0, 0)).length() < 1e-12);
        const auto from = by - Vec3d(1, 0, 0);
        for (int c = 0; c < 3; ++c) REQUIRE(std::abs(from[c]) <= 0.25);
        far += from.length() > 0.1;
        mean += from / 500;
    }
    CHECK(far > 350);
    CHECK(mean.length() < 0.03);

    // The same points a little later, and in another order.
    auto later = positions;
    auto ids = identities;
    for (auto& at : later) at += Vec3d(0, 0.3, -0.2);
    std::ranges::reverse(later);
    std::ranges::reverse(ids);
    for (const auto& [id, by] : copies(later, ids, 0.25))
        if (std::abs(off.at(id).x() - 1) < 0.04) CHECK((by - off.at(id)).length() < 1e-9);
}

TEST_CASE(
    "points of both kinds of file carve alike, and without seams they are the very same, and "
    "threads change nothing") {
    const auto positions = scattered(BBoxd(Vec3d(-2, -2, -2), Vec3d(33, 13, 15)), 30000, 16);
    const auto list = points_at(positions), grid = in_vdb(list);
    const auto lattice = std::make_shared<Lattice>(points_box);
    const auto set = [&](const Seams& seams) { return Payload(std::make_shared<Seams>(seams)); };
    NodeBench node(remap_points());
    const auto run = [&](const Points& points, const Seams& seams) {
        return node
            .run({{"source", {Payload(std::make_shared<Points>(points))}},
                  {"lattice", {Payload(lattice)}},
                  {"seams", {set(seams)}}})
            .at("points")
            .as<Points>();
    };
    const auto none = run(grid, straight_seams(points_box, Axis::u, Kind::remove, {}));
    CHECK(none->grid == grid.grid);
    CHECK(run(list, straight_seams(points_box, Axis::u, Kind::remove, {}))->ply == list.ply);

    std::mt19937 random(17);
    const auto seams =
        random_pairs(random, points_box, points_box.shape, Axis::u, Kind::insert, 4, {1});
    const auto a = run(list, seams), b = run(grid, seams);
    REQUIRE(a->size() == b->size());
    CHECK(a->size() != positions.size());
    const auto by_id = [](const Points& points) {
        std::multimap<std::uint64_t, Vec3d> out;
        const auto ids = points.identities();
        const auto at = points.positions();
        for (std::size_t n = 0; n < ids.size(); ++n) out.emplace(ids[n], at[n]);
        return out;
    };
    const auto in_list = by_id(*a), in_grid = by_id(*b);
    for (std::uint64_t id = 0; id < positions.size(); ++id) {
        REQUIRE(in_list.count(id) == in_grid.count(id));
        Vec3d sum(0);
        for (auto [at, end] = in_list.equal_range(id); at != end; ++at) sum += at->second;
        for (auto [at, end] = in_grid.equal_range(id); at != end; ++at) sum -= at->second;
        REQUIRE(sum.length() < 1e-6);
    }
    tbb::task_arena one(1);
    std::shared_ptr<const Points> alone;
    one.execute([&] { alone = run(grid, seams); });
    CHECK(bytes(alone->grid->constBaseTree()) == bytes(b->grid->constBaseTree()));
    CHECK(
        bytes(carve_grid(grid.grid, points_box, map_of(points_box, {seams}), Interpolation::linear)
                  ->constBaseTree()) == bytes(b->grid->constBaseTree()));
}

TEST_CASE("points that a carve does not reach keep every bit, in leaves that change too") {
    // Far from the origin, where the arithmetic of a move and back would show.
    const auto lattice = make_box(Vec3d(1000.1, 0, 0), {30, 12, 14}, 1.0, {0, 1, 2});
    const auto positions = scattered(BBoxd(Vec3d(1000, 0, 0), Vec3d(1030, 11, 13)), 20000, 18);
    const auto grid = in_vdb(points_at(positions));
    const auto map = map_of(lattice, {straight_seams(lattice, Axis::u, Kind::remove, {12})});
    const auto carved = carve_points(grid.positions(), grid.identities(), lattice, map, 0);
    const auto out = with_images(grid, carved.images);
    std::map<std::uint64_t, Vec3d> was;
    const auto ids = grid.identities();
    const auto at = grid.positions();
    for (std::size_t n = 0; n < ids.size(); ++n) was[ids[n]] = at[n];
    const auto new_ids = out.identities();
    const auto new_at = out.positions();
    int same = 0;
    for (std::size_t n = 0; n < new_ids.size(); ++n) {
        if (was.at(new_ids[n]).x() > 1011.6) continue;
        ++same;
        REQUIRE(new_at[n] == was.at(new_ids[n]));
    }
    CHECK(same > 5000);
    CHECK(out.size() == positions.size() - carved.deleted);
}

TEST_CASE(
    "the report counts what became of the points, frame by frame, and seams that move need points "
    "that do") {
    struct Told : Context::Host {
        nlohmann::ordered_json entry;
        void report(const std::string& section, const nlohmann::ordered_json& told) override {
            CHECK(section == "points");
            entry.update(told);
        }
    } told;
    const std::vector<int> frames{41, 42};
    const auto lattice = std::make_shared<Lattice>(points_box);
    auto seams = straight_seams(points_box, Axis::u, Kind::remove, {10}, frames);
    const auto entries = seams.seams[0].at.all();
    std::fill(entries.begin() + static_cast<std::ptrdiff_t>(seams.columns_per_frame()),
              entries.end(), std::uint16_t{20});
    const auto points = points_at(
        {Vec3d(5, 5, 5), Vec3d(10.2, 5, 5), Vec3d(15, 5, 5), Vec3d(20.2, 5, 5), Vec3d(25, 5, 5)});
    NodeBench node(remap_points());
    const NodeBench::Inputs inputs{{"source", {Payload(std::make_shared<Points>(points))}},
                                   {"lattice", {Payload(lattice)}},
                                   {"seams", {Payload(std::make_shared<Seams>(seams))}}};
    CHECK(node.run(inputs, Context(told, frames).at(0)).at("points").as<Points>()->positions() ==
          std::vector{Vec3d(5, 5, 5), Vec3d(14, 5, 5), Vec3d(19.2, 5, 5), Vec3d(24, 5, 5)});
    CHECK(node.run(inputs, Context(told, frames).at(1)).at("points").as<Points>()->positions() ==
          std::vector{Vec3d(5, 5, 5), Vec3d(10.2, 5, 5), Vec3d(15, 5, 5), Vec3d(24, 5, 5)});
    CHECK(
        told.entry.dump() ==
        R"({"41":{"points":5,"moved":3,"deleted":1,"copied":0},"42":{"points":5,"moved":1,"deleted":1,"copied":0}})");
    CHECK(failure_of([&] { node.run(inputs, Context(told, frames)); }) ==
          "the source is one file for all frames, but the seams change from frame to frame; read "
          "it by a path with a frame token");
}

TEST_CASE("a volume with points is carved whole") {
    const auto river =
        read_points(std::string(TEST_DATA) + "/river/river.0043.vdb", "", PointOffset::detect, {});
    const auto lattice =
        make_box(river.grid->indexToWorld(Vec3d(42, 6, 4)), {20, 36, 10}, 0.0625, {0, 1, 2});
    const auto map = map_of(lattice, {wavy_seams(lattice, Axis::v, Kind::remove, 14, 5, 1.0)});
    Volume volume;
    volume.grids = {river.grid};
    const auto carved = carve_volume(volume, lattice, map, Interpolation::linear);
    const auto counts =
        carve_points(river.positions(), river.identities(), lattice, map, default_jitter);
    CHECK(point_count(*carved.grids[0].grid()) == river.size() - counts.deleted);
    CHECK(counts.deleted > 500);
    CHECK(carved.grids[0]->transform() == river.grid->transform());
    CHECK(kept_metadata(*carved.grids[0].grid()) == kept_metadata(*river.grid));
}
