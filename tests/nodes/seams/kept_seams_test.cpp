#include "tests/support/filed.h"
#include "tests/support/seams_through.h"
#include "tests/support/wavy_seams.h"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Vec3d;

// Seams in the work folder.

TEST_CASE("kept seams come back as they were, in less than half of their memory") {
    const auto lattice = make_box(Vec3d(0), {200, 60, 50}, 1.0, {0, 1, 2});
    const auto seams = std::make_shared<const Seams>(
        GENERATE(true, false)
            ? wavy_seams(lattice, Axis::u, Seams::Kind::insert, 100, 4, 20)
            : straight_seams(lattice, Axis::u, Seams::Kind::remove, {0, 90, 197}));
    const auto bytes = filed(seams);
    const auto back = read_back<Seams>(bytes);
    REQUIRE(back->seams.size() == seams->seams.size());
    for (std::size_t n = 0; n < seams->seams.size(); ++n)
        CHECK(std::ranges::equal(back->seams[n].at.all(), seams->seams[n].at.all()));
    const auto memory = builtin().payload(typeid(Seams)).bytes(Payload(seams));
    CHECK(bytes.size() < memory / 2);
}
