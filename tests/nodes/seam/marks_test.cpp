#include "carve/solver/costs/marks.h"
#include "carve/lattice/mapping.h"
#include "carve/mask/sphere.h"
#include "carve/remap/grid.h"
#include "carve/solver/costs/code.h"
#include "carve/solver/greedy.h"
#include "carve/solver/pyramid.h"
#include "carve/volume/volume.h"
#include "nodes/seam.h"
#include "tests/support/bent_lattices.h"
#include "tests/support/reference_carve.h"
#include "tests/support/solver_bench.h"

#include <openvdb/io/File.h>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

// Masks that solvers take: which vertices they mark, and what becomes of them.

namespace {

/// Which vertices a mask marks, in the order of the codes.
std::vector<bool> marked(const openvdb::GridBase& mask, const Lattice& lattice,
                         Axis axis = Axis::u) {
    std::vector<std::uint16_t> codes(static_cast<std::size_t>(lattice.shape[0]) *
                                     static_cast<std::size_t>(lattice.shape[1]) *
                                     static_cast<std::size_t>(lattice.shape[2]));
    const auto count = mark_vertices(mask, lattice, axis, protected_code, codes);
    CHECK(count == static_cast<std::size_t>(std::ranges::count(codes, protected_code)));
    std::vector<bool> out;
    for (const auto code : codes) out.push_back(code == protected_code);
    return out;
}

/// From the definition: whether one of the voxels around a place in index space is set.
bool set_around(const MaskGrid& mask, const Vec3d& at) {
    for (int n = 0; n < 8; ++n) {
        Coord voxel;
        for (int d = 0; d < 3; ++d) {
            const double whole = std::round(at[d]),
                         place = std::abs(at[d] - whole) <= 1e-5 ? whole : at[d];
            voxel[d] = static_cast<int>(n >> d & 1 ? std::ceil(place) : std::floor(place));
        }
        if (mask.tree().isValueOn(voxel)) return true;
    }
    return false;
}

}  // namespace

TEST_CASE(
    "a vertex on a voxel counts where that voxel is set, one between voxels where any of those "
    "around it is") {
    const auto mask = mask_grid({Coord(2, 3, 1)});
    const auto count = [&](const Vec3d& first, double spacing) {
        const auto set = marked(*mask, make_box(first, {8, 8, 8}, spacing, {0, 1, 2}));
        return std::ranges::count(set, true);
    };
    CHECK(count(Vec3d(0), 1) == 1);
    CHECK(count(Vec3d(1e-7, 0, 0), 1) == 1);
    CHECK(count(Vec3d(0.5, 0, 0), 1) == 2);
    CHECK(count(Vec3d(0.5, 0, 0.1), 1) == 4);
    CHECK(count(Vec3d(0.5, 0.9, 0.1), 1) == 8);
    // Less than a voxel from the set one, on both sides.
    CHECK(count(Vec3d(0), 0.5) == 27);
    CHECK(count(Vec3d(0, 1, 1), 2) == 1);
    CHECK(count(Vec3d(1, 0, 0), 2) == 0);

    const auto on = marked(*mask, box({4, 5, 6}));
    for (std::size_t n = 0; n < on.size(); ++n) CHECK(on[n] == (n == 2 + 4 * (3 + 5 * 1)));
    const auto along_v = marked(*mask, box({4, 5, 6}), Axis::v);
    for (std::size_t n = 0; n < along_v.size(); ++n)
        CHECK(along_v[n] == (n == 3 + 5 * (2 + 4 * 1)));
}

TEST_CASE("masks are seen from bent lattices and through their transform, tiles too") {
    std::mt19937 random(13);
    for (int n = 0; n < 20; ++n) {
        const auto lattice = n % 4 == 0 ? make_box(Vec3d(-2.1, 3.3, 1.7), {9, 8, 7}, 0.7, {2, 0, 1})
                                        : random_bent(random, n % 2 == 0);
        const auto mask = MaskGrid::create();
        mask->setTransform(openvdb::math::Transform::createLinearTransform(n % 3 == 0 ? 0.4 : 1.1));
        CoordBBox reach;
        for (int k = 0; k < lattice.shape[2]; ++k)
            for (const int i : {0, lattice.shape[0] - 1})
                for (const int j : {0, lattice.shape[1] - 1})
                    reach.expand(
                        Coord::round(mask->worldToIndex(lattice.position(Vec3d(i, j, k)))));
        for (int voxels = 0; voxels < 2000; ++voxels) {
            Coord at;
            for (int d = 0; d < 3; ++d) at[d] = reach.min()[d] + below(random, reach.dim()[d]);
            mask->tree().setValueOn(at);
        }
        mask->tree().addTile(1, reach.getStart().offsetBy(reach.dim().x() / 2, 0, 0), true, true);
        const auto set = marked(*mask, lattice);
        std::size_t place = 0, count = 0, wrong = 0;
        for (int k = 0; k < lattice.shape[2]; ++k)
            for (int j = 0; j < lattice.shape[1]; ++j)
                for (int i = 0; i < lattice.shape[0]; ++i, ++place) {
                    const bool want =
                        set_around(*mask, mask->worldToIndex(lattice.position(Vec3d(i, j, k))));
                    count += want;
                    wrong += set[place] != want;
                }
        INFO("case " << n);
        CHECK(wrong == 0);
        CHECK(count > 0);
    }
}

TEST_CASE("the active voxels of any grid are a mask, whatever their value, and points are none") {
    const auto lattice = box({4, 4, 4});
    const auto want = marked(*mask_grid({Coord(1, 2, 3)}), lattice);
    const auto check = [&](auto grid) {
        grid->tree().setValueOn(
            Coord(1, 2, 3), openvdb::zeroVal<typename std::decay_t<decltype(*grid)>::ValueType>());
        CHECK(marked(*grid, lattice) == want);
    };
    check(FloatGrid::create(7));
    check(VectorGrid::create());
    check(openvdb::BoolGrid::create());
    check(openvdb::Int32Grid::create());
    auto level_set = FloatGrid::create(3);
    level_set->setGridClass(openvdb::GRID_LEVEL_SET);
    check(level_set);
    auto points = openvdb::points::PointDataGrid::create();
    points->setName("drops");
    CHECK(failure_of([&] { marked(*points, lattice); }) ==
          "grid 'drops' is of type Tree_ptdataidx32_5_4_3, which is not a mask; make a mask from a "
          "field with mask.threshold");
}

TEST_CASE(
    "masks are taken frame by frame or once for all, and what is protected is not attracted") {
    const auto flat =
        energy_grid(CoordBBox(Coord(0), Coord(5, 0, 0)), [](const Coord&) { return 1.0f; });
    const auto run = [&](const std::string& yaml, const Grids& masks) {
        return solve(seam_graph_cut(), yaml, {flat}, {box({6, 1, 1})}, masks, 3);
    };
    const auto at = [](const Solved& solved) {
        const auto entries = solved.seams->seams[0].at.all();
        return std::vector<int>(entries.begin(), entries.end());
    };
    const auto one = mask_grid({Coord(3, 0, 0)}), next = mask_grid({Coord(4, 0, 0)}),
               other = mask_grid({Coord(5, 0, 0)});
    CHECK(at(run("{count: -1}", {{"attract", {one}}})) == std::vector{3, 3, 3});
    const auto moving = run("{count: -1}", {{"attract", {one, next, other}}});
    CHECK(at(moving) == std::vector{3, 4, 5});
    CHECK(moving.listener.entry["attracted"] == nlohmann::ordered_json({3}));
    CHECK(moving.listener.entry["energy"] == nlohmann::ordered_json({0.0}));
    CHECK(!moving.listener.entry.contains("protected"));
    CHECK(at(run("{count: -1}", {{"attract", {one, next, other}},
                                 {"protect", {mask_grid({Coord(3, 0, 0), Coord(5, 0, 0)})}}})) ==
          std::vector{4, 4, 4});

    const auto guarded =
        mask_grid({Coord(0, 0, 0), Coord(1, 0, 0), Coord(2, 0, 0), Coord(3, 0, 0), Coord(5, 0, 0)});
    const auto past = run("{count: -1}", {{"protect", {guarded}}});
    CHECK(at(past) == std::vector{4, 4, 4});
    CHECK(past.listener.entry["protected"] == nlohmann::ordered_json::array({0}));
    CHECK(past.listener.entry["energy"] == nlohmann::ordered_json({3.0}));
    CHECK(past.listener.warnings.empty());
    // Inserted vertices double none that is protected.
    CHECK(at(run("{count: 1}", {{"protect", {guarded}}})) == std::vector{4, 4, 4});
    const auto pairs =
        run("{count: -1, window: [0, 2], pair_window: [3, 5]}",
            {{"protect", {mask_grid({Coord(0, 0, 0), Coord(2, 0, 0), Coord(3, 0, 0)})}}});
    CHECK(at(pairs) == std::vector{1, 1, 1});
    CHECK(pairs.seams->pairs[0].at == SeamEntries{4, 4, 4});
    CHECK(pairs.listener.entry["pair_protected"] == nlohmann::ordered_json::array({0}));
}

TEST_CASE("a mask that misses the lattice, and attraction that seams do not reach, are warned of") {
    const auto flat =
        energy_grid(CoordBBox(Coord(0), Coord(5, 0, 0)), [](const Coord&) { return 1.0f; });
    const auto run = [&](const std::string& yaml, const Grids& masks) {
        return solve(seam_graph_cut(), yaml, {flat}, {box({6, 1, 1})}, masks, 1).listener.warnings;
    };
    CHECK(run("{count: -1}", {{"protect", {mask_grid({Coord(9, 0, 0)})}}}) ==
          std::vector<std::string>{
              "`protect` is set around no vertex of the lattice: nothing is protected"});
    CHECK(run("{count: -1}", {{"attract", {mask_grid({})}}}) ==
          std::vector<std::string>{
              "`attract` is set around no vertex of the lattice: nothing is attracted"});
    CHECK(run("{count: -2, window: [0, 2]}",
              {{"attract", {mask_grid({Coord(2, 0, 0), Coord(4, 0, 0)})}}}) ==
          std::vector<std::string>{
              "1 of 2 seams take nothing of `attract`, though some of it is left: it is out of "
              "their window, or the path there is too long; "
              "seam.greedy sees only vertices beside its path, other solvers see all"});
    CHECK(run("{count: -2}", {{"attract", {mask_grid({Coord(2, 0, 0), Coord(4, 0, 0)})}}}).empty());
    CHECK(run("{count: -3}", {{"attract", {mask_grid({Coord(2, 0, 0), Coord(4, 0, 0)})}}}).empty());
}

TEST_CASE(
    "masks travel with what earlier seams carved, and a new vertex is marked if either neighbour "
    "is") {
    std::mt19937 random(14);
    const std::vector<int> frames{5, 6, 7};
    const Layout layout;
    for (int n = 0; n < 30; ++n) {
        const auto lattice =
            box({8 + below(random, 6), 8 + below(random, 6), 6 + below(random, 4)});
        const CoordBBox space(
            Coord(0), Coord(lattice.shape[0] - 1, lattice.shape[1] - 1, lattice.shape[2] - 1));
        const auto after = random_sets(random, lattice, 1 + n % 3, 2, frames);
        const auto shape = after.back()->shape_after(after.back()->seams.size());
        // Everything that only one of many carved spaces shows: energies, and masks of few voxels.
        std::vector<FloatGrid::Ptr> energy, carved;
        Grids masks, carved_masks;
        for (std::size_t t = 0; t < frames.size(); ++t) {
            energy.push_back(energy_grid(
                space, [&](const Coord&) { return static_cast<float>(below(random, 64)); }));
            const auto mean = [](const auto& a, const auto& b) {
                return Dense<float>::Voxel{0.5f * (a.value + b.value), true};
            };
            const auto either = [](const auto& a, const auto& b) {
                return Dense<float>::Voxel{std::max(a.value, b.value), true};
            };
            const auto carve_all = [&](const FloatGrid& grid, const auto& between) {
                Dense<float> dense(grid, CoordBBox(Coord(0), Coord(23, 23, 23)));
                for (const auto& set : after)
                    carve(dense, layout, *set, t, set->seams.size(), 0.0f, between);
                return dense;
            };
            const CoordBBox left(Coord(0), Coord(shape[0] - 1, shape[1] - 1, shape[2] - 1));
            auto dense = carve_all(*energy.back(), mean);
            carved.push_back(
                energy_grid(left, [&](const Coord& at) { return dense.at(at).value; }));
            // Nothing is both: where neighbours are marked otherwise, protection comes first.
            const auto guarded = energy_grid(
                space, [&](const Coord&) { return below(random, 12) == 0 ? 1.0f : 0.0f; });
            const auto wanted = energy_grid(space, [&](const Coord& at) {
                return guarded->tree().getValue(at) == 0 && below(random, 12) == 0 ? 1.0f : 0.0f;
            });
            for (const auto& [name, grid] :
                 {std::pair("protect", guarded), std::pair("attract", wanted)}) {
                auto set = carve_all(*grid, either);
                std::vector<Coord> before, now;
                for (auto at = space.begin(); at; ++at)
                    if (grid->tree().getValue(*at) > 0) before.push_back(*at);
                for (auto at = left.begin(); at; ++at)
                    if (set.at(*at).value > 0) now.push_back(*at);
                masks[name].push_back(mask_grid(before));
                carved_masks[name].push_back(mask_grid(now));
            }
        }
        const std::string yaml =
            n % 2 ? "{count: -2, axis: u, window: [1, 4]}" : "{count: 2, axis: v}";
        const auto run = [&](const auto& energies, const Lattice& in, const Grids& marks,
                             const std::vector<Ref<Seams>>& sets) -> std::optional<Solved> {
            try {
                return solve(seam_graph_cut(), yaml, energies, {in}, marks, 3, sets);
            } catch (const Failure& failure) {
                REQUIRE(std::string(failure.what()).find("possible in window") !=
                        std::string::npos);
                return std::nullopt;
            }
        };
        const auto got = run(energy, lattice, masks, after),
                   want = run(carved, box(shape), carved_masks, {});
        INFO("case " << n);
        REQUIRE(got.has_value() == want.has_value());
        if (!got) continue;
        REQUIRE(got->seams->seams.size() == want->seams->seams.size());
        for (std::size_t s = 0; s < got->seams->seams.size(); ++s)
            CHECK(got->seams->seams[s].at == want->seams->seams[s].at);
        CHECK(got->listener.entry["attracted"] == want->listener.entry["attracted"]);
    }
}

TEST_CASE("seams that run out say how many are possible, and where and when there is no way") {
    // Behind x = 3 all is protected in frame 6 at (y, z) = (1, 2); in front of it three vertices
    // are free.
    const CoordBBox space(Coord(0), Coord(7, 2, 3));
    const auto flat = energy_grid(space, [](const Coord&) { return 1.0f; });
    std::vector<Coord> wall;
    for (int x = 3; x < 8; ++x) wall.emplace_back(x, 1, 2);
    const Grids masks{{"protect", {mask_grid({}), mask_grid(wall), mask_grid({})}}};
    const auto failure = [&](NodeType type, const std::string& yaml,
                             const std::vector<Lattice>& lattices, const Grids& marks,
                             const std::vector<Ref<Seams>>& after = {}) {
        return failure_of([&] { solve(std::move(type), yaml, {flat}, lattices, marks, 3, after); });
    };
    const std::string told =
        "3 of 5 seams are possible in window [0, 7]: in frame 6 column (0 to 7, 1, 2), from (0, 1, "
        "2) to (7, 1, 2), has no unprotected vertex left; "
        "ask for fewer, widen the window or protect less; `best_effort: true` takes as many as "
        "there are (--set NODE.best_effort=true)";
    for (const auto& type : {seam_greedy(), seam_pyramid(), seam_graph_cut()})
        CHECK(failure(type, "{count: -5}", {box({8, 3, 4})}, masks) == told);
    CHECK(solve(seam_pyramid(), "{count: -3}", {flat}, {box({8, 3, 4})}, masks, 3)
              .seams->seams.size() == 3);
    CHECK(failure(seam_greedy(), "{count: 4}", {box({8, 3, 4})}, masks) ==
          "3 of 4 seams are possible in window [0, 7]: in frame 6 column (0 to 6, 1, 2), from (0, "
          "1, 2) to (6, 1, 2), has no unprotected vertex left; "
          "ask for fewer, widen the window or protect less; `best_effort: true` takes as many as "
          "there are (--set NODE.best_effort=true)");
    CHECK(failure(seam_greedy(), "{count: -2, static: true, window: [2, 5]}", {box({8, 3, 4})},
                  masks) ==
          "1 of 2 seams is possible in window [2, 5]: over all frames column (2 to 5, 1, 2), from "
          "(2, 1, 2) to (5, 1, 2), has no unprotected vertex left; "
          "ask for fewer, widen the window or protect less; `best_effort: true` takes as many as "
          "there are (--set NODE.best_effort=true)");
    CHECK(failure(seam_greedy(), "{count: 1, window: [0, 2], pair_window: [4, 6]}",
                  {box({8, 3, 4})}, masks) ==
          "no seam is possible in pair_window [4, 6]: in frame 6 column (4 to 6, 1, 2), from (4, "
          "1, 2) to (6, 1, 2), has no unprotected vertex left; "
          "ask for fewer, widen the window or protect less");
    // Along v, in a lattice that moves.
    const auto moved = make_box(Vec3d(0, 0, 2), {8, 3, 2}, 1.0, {0, 1, 2});
    const Grids across{{"protect", {mask_grid({Coord(4, 0, 2), Coord(4, 1, 2), Coord(4, 2, 2)})}}};
    CHECK(failure(seam_greedy(), "{count: -1, axis: v}", {box({8, 3, 2}), moved, moved}, across) ==
          "no seam is possible in window [0, 2]: in frame 6 column (4, 0 to 2, 0), from (4, 0, 2) "
          "to (4, 2, 2), has no unprotected vertex left; "
          "ask for fewer, widen the window or protect less");
    // Free vertices that a seam would have to jump to.
    std::vector<Coord> gaps;
    for (int x = 0; x < 8; ++x) {
        if (x != 1) gaps.emplace_back(x, 0, 0);
        if (x != 4) gaps.emplace_back(x, 1, 0);
    }
    CHECK(
        failure(seam_greedy(), "{count: -1}", {box({8, 3, 4})}, {{"protect", {mask_grid(gaps)}}}) ==
        "no seam is possible in window [0, 7]: in frame 5 of the 8 vertices left in column (0 to "
        "7, 0, 0), from (0, 0, 0) to (7, 0, 0), 1 is unprotected, but "
        "out of reach from the columns beside; ask for fewer, widen the window or protect less");
    // Places are those of the lattice, not of what earlier seams left.
    Seams before;
    before.shape = {8, 3, 4};
    before.frames = {5, 6, 7};
    before.lattice_hash = box({8, 3, 4}).hash;
    before.seams = {{std::vector<std::uint16_t>(36, 0)}, {std::vector<std::uint16_t>(36, 0)}};
    CHECK(failure(seam_greedy(), "{count: -5}", {box({8, 3, 4})}, masks,
                  {std::make_shared<Seams>(before)}) ==
          "1 of 5 seams is possible in window [0, 5]: in frame 6 column (0 to 5, 1, 2), from (2, "
          "1, 2) to (7, 1, 2), has no unprotected vertex left; "
          "ask for fewer, widen the window or protect less; `best_effort: true` takes as many as "
          "there are (--set NODE.best_effort=true)");
}

TEST_CASE("a ball that is attracted vanishes from a plume, and a protected one stays whole") {
    openvdb::initialize();
    openvdb::io::File file(TEST_DATA "/plume/plume.0051.vdb");
    file.open();
    const auto density = openvdb::gridPtrCast<FloatGrid>(file.readGrid("density"));
    const auto voxels = density->evalActiveVoxelBoundingBox();
    const double size = density->voxelSize().x();
    const auto first = density->indexToWorld(voxels.min());
    const auto dim = voxels.dim();
    const auto lattice = make_box(first, {dim.x(), dim.y(), dim.z()}, size, {0, 1, 2});
    const auto ball = sphere_mask(*density, density->indexToWorld(Coord(21, 21, 25)), 3.2 * size);
    REQUIRE(ball->activeVoxelCount() > 100);
    const auto carved_ball = [&](const Solved& solved) {
        const CarveMap map(lattice, {solved.seams}, 5, std::nullopt);
        return openvdb::gridConstPtrCast<MaskGrid>(
                   carve_grid(ball, lattice, map, Interpolation::linear))
            ->activeVoxelCount();
    };
    // Seven voxels across. The density itself is what seams avoid.
    const auto gone =
        solve(seam_pyramid(), "{count: -7}", {density}, {lattice}, {{"attract", {ball}}}, 1);
    CHECK(carved_ball(gone) == 0);
    CHECK(gone.listener.warnings.empty());
    std::size_t taken = 0;
    for (const auto& n : gone.listener.entry["attracted"]) taken += n.get<std::size_t>();
    CHECK(taken == ball->activeVoxelCount());
    // A window that leaves no more room beside the ball than these seams take.
    const std::string window = ", window: [11, 31]}";
    for (const auto& type : {seam_greedy(), seam_pyramid()}) {
        const auto whole =
            solve(type, "{count: -14" + window, {density}, {lattice}, {{"protect", {ball}}}, 1);
        CHECK(carved_ball(whole) == ball->activeVoxelCount());
        CHECK(carved_ball(solve(type, "{count: -14" + window, {density}, {lattice}, {}, 1)) <
              ball->activeVoxelCount());
        for (const auto& n : whole.listener.entry["protected"]) CHECK(n == 0);
        CHECK(
            failure_of([&] {
                solve(type, "{count: -15" + window, {density}, {lattice}, {{"protect", {ball}}}, 1);
            }).starts_with("14 of 15 seams are possible in window [11, 31]: in frame 5 "));
    }
}
