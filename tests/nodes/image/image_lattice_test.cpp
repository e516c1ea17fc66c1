#include "carve/lattice/build.h"
#include "carve/remap/grid.h"
#include "carve/rig/circle.h"
#include "carve/solver/costs/sample.h"
#include "carve/solver/pyramid.h"
#include "carve/solver/search/find_seams.h"
#include "formats/image/image_volume.h"
#include "nodes/energy_image.h"
#include "tests/support/seams_through.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace fluidcarve;

namespace {

constexpr int width = 96, height = 80;

/// A dark disc of radius 20 around the middle, on light noise.
Volume disc() {
    Image out;
    out.format = "openexr";
    out.data = out.display = {0, 0, width, height};
    out.channels = {{"R", "float"}, {"G", "float"}};
    std::uint32_t state = 1;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 2; ++c) {
                state = state * 1664525 + 1013904223;
                const bool inside = std::hypot(x - 47.5, y - 39.5) < 20;
                out.pixels.push_back((inside ? 0.0f : 0.8f) +
                                     0.1f * static_cast<float>(state >> 8) * 0x1p-24f);
            }
    return volume_of(out);
}

std::size_t dark(const Volume& volume) {
    std::size_t out = 0;
    const auto grid = openvdb::gridConstPtrCast<FloatGrid>(volume.grids[0]);
    for (auto at = grid->cbeginValueOn(); at; ++at) out += *at < 0.4f ? 1 : 0;
    return out;
}

Seams pairs_in(const Volume& volume, const Lattice& lattice, Seams::Kind kind, int count,
               Window window, Window pair_window) {
    auto out = test::no_seams(lattice, Axis::u, kind);
    EnergyVolume energy({lattice.shape, Axis::u, 1, lattice.closed});
    sample_energy(*image_energy(volume), lattice, Axis::u, energy.codes(0));
    out.pairs = find_seams(energy, {opposite(kind), pair_window}, count,
                           Pyramid(Quality::normal, 16), [](double) {})
                    .seams;
    EnergyVolume again({lattice.shape, Axis::u, 1, lattice.closed});
    sample_energy(*image_energy(volume), lattice, Axis::u, again.codes(0));
    out.seams =
        find_seams(again, {kind, window}, count, Pyramid(Quality::normal, 16), [](double) {}).seams;
    return out;
}

}  // namespace

TEST_CASE(
    "pairs of seams in a polar lattice on an image move what is between them, and not a bit of the "
    "rest",
    "[images]") {
    const auto volume = disc();
    LatticeSpec spec;
    spec.spacing = 1;
    spec.u = {-16, 16};
    spec.v = {0, 0.5};
    const auto lattice =
        build_lattice(circle_rig({47.5, 39.5, 0}, {0, 0, 1}, {20, 20}, 0), spec).lattice;
    REQUIRE(lattice.shape[0] == 33);
    REQUIRE(lattice.shape[1] == 1);
    REQUIRE(lattice.closed);
    const auto before = dark(volume);
    for (const auto kind : {Seams::Kind::remove, Seams::Kind::insert}) {
        const auto seams =
            std::make_shared<Seams>(pairs_in(volume, lattice, kind, 4, {2, 12}, {20, 30}));
        const auto carved = carve_volume(
            volume, lattice, CarveMap(lattice, {seams}, 1, std::nullopt), Interpolation::linear);
        for (std::size_t n = 0; n < 2; ++n) {
            const auto was = openvdb::gridConstPtrCast<FloatGrid>(volume.grids[n]),
                       now = openvdb::gridConstPtrCast<FloatGrid>(carved.grids[n]);
            CHECK(now->evalActiveVoxelBoundingBox() ==
                  openvdb::CoordBBox({0, 0, 0}, {width - 1, height - 1, 0}));
            CHECK(now->activeVoxelCount() == width * height);
            std::size_t moved = 0;
            for (auto at = was->cbeginValueOn(); at; ++at) {
                const auto radius = std::hypot(at.getCoord().x() - 47.5, at.getCoord().y() - 39.5);
                const bool same = now->tree().getValue(at.getCoord()) == *at;
                // The lattice begins at radius 4; windows reach from 6 to 34.
                if (radius < 4 || radius > 36) REQUIRE(same);
                moved += same ? 0 : 1;
            }
            CHECK(moved > 500);
        }
        // Radius 16 or 24 instead of 20.
        const double area = static_cast<double>(dark(carved)) / static_cast<double>(before);
        CHECK(area == Approx(kind == Seams::Kind::remove ? 0.64 : 1.44).epsilon(0.08));
        const auto out =
            image_of(carved, {format_of_name("a.exr"), {}, {}}, [](const std::string&) {});
        CHECK(out.data == Image::Window{0, 0, width, height});
    }
}

TEST_CASE("a lattice along an open rig on an image narrows a band of it", "[images]") {
    const auto volume = disc();
    LatticeSpec spec;
    spec.spacing = 1;
    spec.u = {-10, 10};
    spec.v = {0, 0.5};
    // From left to right through the disc's lower part; `u` then points down or up.
    const Rig rig{{{0, 20, 0}, {95, 20, 0}}, false, openvdb::Vec3d(0, 0, 1), {}};
    const auto lattice = build_lattice(rig, spec).lattice;
    CHECK(lattice.shape == std::array<int, 3>{21, 1, 96});
    const auto seams = std::make_shared<Seams>(
        pairs_in(volume, lattice, Seams::Kind::remove, 2, {0, 8}, {10, 19}));
    const auto carved = carve_volume(volume, lattice, CarveMap(lattice, {seams}, 1, std::nullopt),
                                     Interpolation::linear);
    const auto was = openvdb::gridConstPtrCast<FloatGrid>(volume.grids[0]),
               now = openvdb::gridConstPtrCast<FloatGrid>(carved.grids[0]);
    std::size_t moved = 0;
    for (auto at = was->cbeginValueOn(); at; ++at) {
        const bool same = now->tree().getValue(at.getCoord()) == *at;
        if (std::abs(at.getCoord().y() - 20) > 10) REQUIRE(same);
        moved += same ? 0 : 1;
    }
    CHECK(moved > 100);
    CHECK(now->activeVoxelCount() == width * height);
}
