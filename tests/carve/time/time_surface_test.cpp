#include "carve/time/time_surface.h"

#include "carve/time/between.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

namespace {

const CoordBBox bar(Coord(0), Coord(95, 7, 7));
constexpr int fading = 6;

/// A bar of values: some in its left half, others in its right half.
FloatGrid::Ptr halves(float left, float right) {
    const auto out = FloatGrid::create();
    out->setName("density");
    for (auto at = bar.begin(); at; ++at)
        out->tree().setValueOn(*at, (*at).x() < 48 ? left : right);
    return out;
}

/// Both sides match in the second frame on the left, in the fifth on the right.
TimeSurface surface_of_halves() {
    const auto end = halves(1, 1);
    TimeSurface out(*end, static_cast<std::size_t>(fading), 3, bar);
    for (int n = 0; n < fading; ++n)
        out.add(*end, *halves(n == 1 ? 1.0f : 2.0f, n == 4 ? 1.0f : 2.0f));
    out.finish();
    return out;
}

}  // namespace

TEST_CASE(
    "each place goes over when both sides match best there, smoothly between them and in time") {
    const auto surface = surface_of_halves();
    const Vec3d left(8, 4, 4), right(88, 4, 4);
    CHECK(surface.share(3, left) > 0.95);
    CHECK(surface.share(3, right) < 0.3);
    CHECK(surface.share(2, right) < 0.05);
    for (int x = 0; x < 96; ++x) {
        const Vec3d at(x, 4, 4);
        CHECK(surface.share(0, at) < 0.35);
        CHECK(surface.share(fading - 1, at) > 0.65);
        CHECK(surface.share(-1, at) == 0);
        CHECK(surface.share(fading, at) == 1);
        for (int n = 1; n < fading; ++n) CHECK(surface.share(n, at) >= surface.share(n - 1, at));
        for (int n = 0; n < fading && x > 0; ++n)
            CHECK(std::abs(surface.share(n, at) - surface.share(n, Vec3d(x - 1, 4, 4))) < 0.1);
    }
}

TEST_CASE(
    "where a mixed volume shows one side alone it has its bits, and a grid that one side lacks "
    "fades") {
    Volume a, b;
    a.grids = {halves(0.1f, 0.3f)};
    const auto other = halves(5, 5);
    other->setName("heat");
    b.grids = {halves(7, 0.7f), other};
    const auto share = [](const Vec3d& at) { return at.x() < 48 ? 0.0 : at.x() < 80 ? 0.25 : 1.0; };
    const auto mixed = volume_mixed(a, b, share, b);
    const auto density = openvdb::gridConstPtrCast<FloatGrid>(mixed.find("density")),
               heat = openvdb::gridConstPtrCast<FloatGrid>(mixed.find("heat"));
    CHECK(density->tree().getValue(Coord(3, 2, 1)) == 0.1f);
    CHECK(density->tree().getValue(Coord(60, 2, 1)) == Approx(0.4));
    CHECK(density->tree().getValue(Coord(90, 2, 1)) == 0.7f);
    CHECK(heat->tree().getValue(Coord(3, 2, 1)) == 0);
    CHECK(heat->tree().getValue(Coord(90, 2, 1)) == 5);
    CHECK(!heat->tree().isValueOn(Coord(3, 2, 1)));
}
