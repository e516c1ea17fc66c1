#include "carve/solver/task/task.h"
#include "tests/support/solver_bench.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;
using namespace fluidcarve::test;

namespace {

const std::vector<int> task_frames{5, 6, 7};
const std::vector<Ref<Seams>> none;

Ref<Lattice> lattice_at(double y) {
    return std::make_shared<Lattice>(make_box(openvdb::Vec3d(0, y, 0), {10, 4, 3}, 1.0, {0, 1, 2}));
}

/// Removes the first vertices along u.
Ref<Seams> removal(const Lattice& lattice, std::size_t count) {
    Seams out;
    out.shape = lattice.shape;
    out.frames = task_frames;
    out.lattice_hash = lattice.hash;
    out.seams.assign(count,
                     {std::vector<std::uint16_t>(out.columns_per_frame() * task_frames.size(), 0)});
    return std::make_shared<Seams>(out);
}

}  // namespace

TEST_CASE("a space is what earlier sets leave, and one frame may stand for all") {
    const std::vector<Ref<Lattice>> one{lattice_at(0)},
        three{lattice_at(0), lattice_at(1), lattice_at(2)};
    const std::vector<Ref<Seams>> six{removal(*one[0], 6)}, twice{six[0], six[0]};
    const CarvedSpace whole(three, none, task_frames), left(one, six, task_frames);
    CHECK(!whole.carved());
    CHECK(whole.shape() == std::array{10, 4, 3});
    CHECK(whole.place(2) == 2);
    CHECK(whole.carve_map(2).empty());
    CHECK(left.carved());
    CHECK(left.shape() == std::array{4, 4, 3});
    CHECK(left.place(2) == 0);
    CHECK(left.carve_map(2).steps().size() == 1);
    CHECK(failure_of([&] { CarvedSpace(one, twice, task_frames); }) ==
          "seam set 2 of 2 carves 10 x 4 x 3 vertices, but set 1 leaves 4 x 4 x 3; list the sets "
          "in the order in which they were found");
}

TEST_CASE("a task counts the vertices of its space, and its pairs are of the other kind") {
    const std::vector<Ref<Lattice>> lattices{lattice_at(0)};
    const std::vector<Ref<Seams>> five{removal(*lattices[0], 5)};
    const CarvedSpace whole(lattices, none, task_frames), left(lattices, five, task_frames);
    SolverParams params;
    params.count = {-20, true};
    const auto first = task_of(params, whole), second = task_of(params, left);
    CHECK(first.count == 2);
    CHECK(first.seams.kind == Seams::Kind::remove);
    CHECK(first.seams.window.last == 9);
    CHECK(!first.pairs);
    CHECK(second.shape == std::array{5, 4, 3});
    CHECK(second.count == 1);
    CHECK(second.seams.window.last == 4);

    params.count = {2, false};
    params.window = VertexRange{1, 3};
    params.pair_window = VertexRange{5, 8};
    params.pair_static = true;
    const auto paired = task_of(params, whole);
    REQUIRE(paired.pairs);
    CHECK(paired.seams.kind == Seams::Kind::insert);
    CHECK(paired.pairs->kind == Seams::Kind::remove);
    CHECK(paired.seams.prefix() == "");
    CHECK(paired.pairs->prefix() == "pair_");
    CHECK(!paired.seams.static_);
    CHECK(paired.pairs->static_);
    CHECK(failure_of([&] { task_of(params, left); }) ==
          "pair_window [5, 8] leaves the lattice, which has 5 vertices along u once the seams of "
          "`after` are carved: 0 to 4");
    params.window = VertexRange{0, 60, true};
    params.pair_window = VertexRange{40, 100, true};
    CHECK(failure_of([&] { task_of(params, whole); }) ==
          "pair_window [40%, 100%] overlaps window [0%, 60%]; it must begin above vertex 5");
    params.pair_window = VertexRange{70, 100, true};
    CHECK(task_of(params, whole).pairs->window.first == 6);
    params.anchor = {Anchor::At::vertex, 10};
    CHECK(failure_of([&] { task_of(params, whole); }) ==
          "anchor 10 lies beyond the lattice, which has 10 vertices along u: 0 to 9");
}

TEST_CASE("a set without seams remembers its lattices, and only windows that were stated") {
    const std::vector<Ref<Lattice>> still{lattice_at(0), lattice_at(0), lattice_at(0)},
        moving{lattice_at(0), lattice_at(1), lattice_at(0)};
    SolverParams params;
    params.count = {-1, false};
    const auto empty = [&](const std::vector<Ref<Lattice>>& lattices) {
        const CarvedSpace space(lattices, none, task_frames);
        return empty_seams(params, task_of(params, space), space);
    };
    CHECK(empty(still).lattice_hash == still[0]->hash);
    CHECK(empty(moving).lattice_hash ==
          moving[0]->hash + "," + moving[1]->hash + "," + moving[2]->hash);
    CHECK(empty(still).frames == task_frames);
    CHECK(!empty(still).window);
    params.window = VertexRange{2, 5};
    REQUIRE(empty(still).window);
    CHECK(empty(still).window->last == 5);
    CHECK(!empty(still).pair_window);
}
