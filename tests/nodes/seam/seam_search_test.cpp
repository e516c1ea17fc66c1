#include "carve/solver/seam_search.h"

#include "nodes/seam.h"
#include "tests/support/scratch.h"
#include "tests/support/solver_bench.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <random>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;

namespace {

constexpr std::array<int, 3> search_lattice{24, 4, 3};
constexpr std::size_t search_frames = 4;

std::vector<FloatGrid::Ptr> noise(unsigned seed) {
    std::vector<FloatGrid::Ptr> out;
    std::mt19937 random(seed);
    for (std::size_t t = 0; t < search_frames; ++t)
        out.push_back(energy_grid(CoordBBox(Coord(0), Coord(23, 3, 2)), [&](const Coord&) {
            return static_cast<float>(random() % 64) / 64;
        }));
    return out;
}

/// What the node finds, and what the library finds by the same request.
std::pair<Ref<Seams>, Ref<Seams>> both(const std::string& yaml, const SolverParams& request,
                                       bool field, const MaskGrid::Ptr& protect = nullptr,
                                       const Limits& limits = {}) {
    const auto energies = noise(1), fields = noise(2);
    Grids grids;
    if (field) grids["field"].assign(fields.begin(), fields.end());
    if (protect) grids["protect"] = {protect};
    const auto solved =
        test::solve(seam_pyramid(), yaml, energies, {box(search_lattice)}, grids, search_frames);
    SeamSearch search(request, {5, 6, 7, 8}, limits);
    const auto lattice = std::make_shared<const Lattice>(box(search_lattice));
    for (std::size_t t = 0; t < search_frames; ++t)
        search.add(lattice, {*energies[t], field ? fields[t].get() : nullptr, protect.get()});
    return {solved.seams, search.find()};
}

/// The same of seams of frames.
SolverParams in_time(int count) {
    SolverParams out;
    out.axis = Axis::t;
    out.count.value = count;
    out.spread = 0;
    return out;
}

void check_equal(const std::pair<Ref<Seams>, Ref<Seams>>& found) {
    const auto& [node, library] = found;
    CHECK(library->thickness == node->thickness);
    CHECK(library->kind == node->kind);
    CHECK(library->lattice_hash == node->lattice_hash);
    for (const auto part : {&Seams::seams, &Seams::pairs}) {
        const auto &a = *node.*part, &b = *library.*part;
        REQUIRE(a.size() == b.size());
        for (std::size_t n = 0; n < a.size(); ++n) {
            CHECK(std::ranges::equal(a[n].at, b[n].at));
            CHECK(a[n].energy == b[n].energy);
        }
    }
}

}  // namespace

TEST_CASE("a search by the library finds the seams of seam.pyramid") {
    SolverParams request;
    request.count = {-3, false};
    check_equal(both("{axis: u, count: -3}", request, false));
    check_equal(both("{axis: u, count: -3}", request, false, mask_grid({{10, 1, 1}})));
    request.count = {6, false};
    request.thickness = 3;
    check_equal(both("{axis: u, count: 6, thickness: 3}", request, true));
    request = {};
    request.count = {-2, false};
    request.window = VertexRange{0, 9};
    request.pair_window = VertexRange{14, 23};
    const std::string pairs = "{axis: u, count: -2, window: [0, 9], pair_window: [14, 23]}";
    check_equal(both(pairs, request, false));
    // Energies and seams in files.
    const Scratch scratch;
    check_equal(both(pairs, request, false, nullptr, {1, scratch / "work"}));
    CHECK(std::filesystem::is_empty(scratch / "work"));
    // A pair without its seam is none.
    const auto wall = MaskGrid::create();
    wall->denseFill(CoordBBox(Coord(1), Coord(9, 3, 2)), true, true);
    request.best_effort = true;
    const auto few =
        both("{axis: u, count: -2, window: [0, 9], pair_window: [14, 23], best_effort: true}",
             request, false, wall);
    check_equal(few);
    CHECK(few.second->seams.size() < 2);
    CHECK(few.second->pairs.size() == few.second->seams.size());
}

TEST_CASE("a search by the library says why there is no seam, and can be stopped") {
    SolverParams request;
    request.count = {-3, false};
    const auto energies = noise(1);
    const auto lattice = std::make_shared<const Lattice>(box(search_lattice));
    const auto wall = MaskGrid::create();
    wall->denseFill(CoordBBox(Coord(0), Coord(23, 0, 0)), true, true);
    SeamSearch blocked(request, {1});
    blocked.add(lattice, {*energies[0], nullptr, wall.get()});
    CHECK_THROWS_WITH(blocked.find(), Catch::Contains("has no unprotected vertex"));

    SeamSearch stopped(request, {1});
    stopped.add(lattice, {*energies[0]});
    CHECK_THROWS_AS(stopped.find([](double) { throw Cancelled{}; }), Cancelled);
}

TEST_CASE("the library finds seams of frames as the node does") {
    check_equal(both("{axis: t, count: -1}", in_time(-1), true));
    check_equal(both("{axis: t, count: 2}", in_time(2), false));
}
