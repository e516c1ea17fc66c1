#include "formats/seam_file/seam_checksum.h"

#include "tests/support/seams_through.h"

#include <catch2/catch.hpp>

#include <functional>
#include <set>

using namespace fluidcarve;
using namespace fluidcarve::test;

TEST_CASE(
    "a checksum of seams depends on all that a seam file holds of them, and on nothing else") {
    const auto lattice = make_box(openvdb::Vec3d(0), {9, 3, 2}, 1, {0, 1, 2});
    const auto seams = straight_seams(lattice, Axis::u, Seams::Kind::remove, {4, 2}, {1, 2});
    const auto sum = seam_checksum(seams);
    CHECK(sum.starts_with("xxh3-128:"));
    CHECK(sum.size() == 9 + 32);
    CHECK(sum == seam_checksum(seams));

    std::set<std::string> sums{sum};
    const std::vector<std::function<void(Seams&)>> changes{
        [](Seams& it) { it.axis = Axis::v; },
        [](Seams& it) { it.kind = Seams::Kind::insert; },
        [](Seams& it) { it.closed = true; },
        [](Seams& it) { it.around = true; },
        [](Seams& it) { it.shape[0] = 10; },
        [](Seams& it) {
            it.frames = {1, 3};
        },
        [](Seams& it) { it.lattice += '.'; },
        [](Seams& it) { it.lattice_hash += '0'; },
        [](Seams& it) {
            it.window = Window{0, 5};
        },
        [](Seams& it) {
            it.pair_window = Window{0, 5};
        },
        [](Seams& it) {
            it.anchor = {Anchor::At::vertex, 3};
        },
        [](Seams& it) { it.seams[1].at.all()[5] = 3; },
        [](Seams& it) { it.seams[1].energy = 1e-300; },
        [](Seams& it) { std::swap(it.seams[0], it.seams[1]); },
        [](Seams& it) { it.seams.pop_back(); },
        [](Seams& it) { it.pairs = it.seams; },
    };
    for (const auto& change : changes) {
        auto other = seams;
        change(other);
        sums.insert(seam_checksum(other));
    }
    CHECK(sums.size() == 1 + changes.size());

    auto bounded = seams;
    bounded.seams[0].lower_bound = 1;
    bounded.shifts = {0, 1, 2};
    CHECK(seam_checksum(bounded) == sum);
}

TEST_CASE("checksums of seams and of warps are those that files of earlier runs hold") {
    Seams stated;
    stated.axis = Axis::u;
    stated.kind = Seams::Kind::remove;
    stated.shape = {9, 3, 2};
    stated.frames = {1, 2};
    stated.lattice = "a box";
    stated.lattice_hash = "xxh3-64:0123456789abcdef";

    auto seams = stated;
    seams.seams = {straight_seam(stated, 4), straight_seam(stated, 2)};
    seams.seams[1].energy = 0.25;
    seams.pairs = {straight_seam(stated, 6), straight_seam(stated, 7)};
    CHECK(seam_checksum(seams) == "xxh3-128:29014860415bca5e745df014b1f686ea");

    auto warp = stated;
    warp.warp.emplace(warp.warp_vertices(), warp.warp_rings(), 1, warp.frames.size());
    for (std::size_t t = 0; t < warp.frames.size(); ++t) {
        float value = 0;
        for (auto& each : warp.warp->values(t)) each = value += 0.25F;
    }
    warp.warp->set_scale(0.5);
    CHECK(seam_checksum(warp) == "xxh3-128:ffe280dc15ed54686a59c5768377d14f");
}
