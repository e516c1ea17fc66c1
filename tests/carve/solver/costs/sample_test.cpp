#include "carve/solver/costs/sample.h"
#include "carve/base/failure.h"
#include "carve/base/frame_store.h"
#include "carve/lattice/snap.h"
#include "carve/solver/costs/code.h"
#include "carve/solver/costs/decode.h"
#include "tests/support/bent_lattices.h"
#include "tests/support/failure_of.h"
#include "tests/support/scratch.h"

#include <openvdb/tools/Interpolation.h>
#include <catch2/catch.hpp>

#include <limits>
#include <random>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

namespace {

openvdb::FloatGrid::Ptr energy_on(const CoordBBox& box, double voxel,
                                  const std::function<double(const Coord&)>& value) {
    const auto out = openvdb::FloatGrid::create();
    out->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
    auto values = out->getAccessor();
    for (auto at = box.begin(); at; ++at) values.setValueOn(*at, static_cast<float>(value(*at)));
    return out;
}

std::vector<std::uint16_t> sampled(const openvdb::FloatGrid& grid, const Lattice& lattice,
                                   Axis axis = Axis::u) {
    std::vector<std::uint16_t> out(static_cast<std::size_t>(lattice.shape[0]) *
                                   static_cast<std::size_t>(lattice.shape[1]) *
                                   static_cast<std::size_t>(lattice.shape[2]));
    sample_energy(grid, lattice, axis, out);
    return out;
}

}  // namespace

TEST_CASE("energy codes keep order and half a thousandth over sixty octaves") {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> exponent(-31, 31.9);
    float last = 0;
    for (unsigned code = 1; code <= highest_energy_code; ++code) {
        const float energy = decode_energy(static_cast<std::uint16_t>(code));
        REQUIRE(energy > last);
        REQUIRE(encode_energy(energy) == code);
        last = energy;
        const auto bits = static_cast<std::uint16_t>(code);
        float together = 0;
        decode_energies({&bits, 1}, {&together, 1});
        REQUIRE(together == energy);
    }
    for (int n = 0; n < 100000; ++n) {
        const auto energy = static_cast<float>(std::exp2(exponent(random)));
        REQUIRE(std::abs(decode_energy(encode_energy(energy)) - energy) <= 4.8829e-4 * energy);
    }
    CHECK(decode_energy(encode_energy(0.0f)) == 0);
    CHECK(decode_energy(encode_energy(1.0f)) == 1);
    CHECK(encode_energy(1e-13f) == 0);
    CHECK(std::abs(decode_energy(encode_energy(1e-11f)) - 1e-11f) <= 0x1p-42f);
}

TEST_CASE("what is no energy has no code") {
    using Limits = std::numeric_limits<float>;
    for (const float energy : {-1.0f, -1e-30f, Limits::infinity(), -Limits::infinity(),
                               Limits::quiet_NaN(), 4.4e9f, Limits::max()})
        CHECK(encode_energy(energy) == invalid_energy_code);
    CHECK(encode_energy(-0.0f) == 0);
    CHECK(encode_energy(4.28e9f) <= highest_energy_code);
}

TEST_CASE("codes are those of the voxels under the vertices, contiguous along the carved axis") {
    const auto grid = energy_on(CoordBBox(Coord(-5), Coord(20)), 0.5, [](const Coord& at) {
        return 1000 + at.x() + 20 * at.y() + 400 * at.z();
    });
    const auto lattice = make_box(Vec3d(1, 0.5, -1), {7, 5, 3}, 0.5, {0, 1, 2});
    for (const auto axis : {Axis::u, Axis::v, Axis::w}) {
        const auto codes = sampled(*grid, lattice, axis);
        for (int k = 0; k < 3; ++k)
            for (int j = 0; j < 5; ++j)
                for (int i = 0; i < 7; ++i) {
                    const auto place = axis == Axis::u   ? (k * 5 + j) * 7 + i
                                       : axis == Axis::v ? (k * 7 + i) * 5 + j
                                                         : (j * 7 + i) * 3 + k;
                    REQUIRE(codes[static_cast<std::size_t>(place)] ==
                            encode_energy(float(1000 + (2 + i) + 20 * (1 + j) + 400 * (-2 + k))));
                }
    }
}

TEST_CASE("columns through leaves and tiles of different values have the codes of their voxels") {
    std::mt19937 random(1);
    const auto grid = openvdb::FloatGrid::create(0.5f);
    for (auto block = CoordBBox(Coord(-2), Coord(3)).begin(); block; ++block) {
        const Coord at((*block).x() * 8, (*block).y() * 8, (*block).z() * 8);
        if (random() % 3 == 0) continue;
        grid->tree().addTile(1, at, static_cast<float>(1 + random() % 3), true);
        if (random() % 3 == 0) grid->tree().setValueOn(at.offsetBy(1, 2, 3), 7.0f);
    }
    for (const double spacing : {1.0, 2.0})
        for (const auto axis : {Axis::u, Axis::v, Axis::w}) {
            const auto lattice = make_box(Vec3d(-13, -11, -5), {18, 17, 15}, spacing, {0, 1, 2});
            const auto codes = sampled(*grid, lattice, axis);
            std::size_t n = 0;
            for (int slice = 0; slice < lattice.shape[slice_dimension(axis)]; ++slice)
                for (int lateral = 0; lateral < lattice.shape[lateral_dimension(axis)]; ++lateral)
                    for (int entry = 0; entry < lattice.shape[dimension(axis)]; ++entry, ++n) {
                        const auto at = lattice.position(
                            Vec3d(vertex_of<double>(axis, entry, lateral, slice).data()));
                        REQUIRE(codes[n] == encode_energy(grid->tree().getValue(Coord::round(at))));
                    }
        }
}

TEST_CASE("vertices between voxels, and on every second, are sampled where they are") {
    const auto grid = energy_on(CoordBBox(Coord(-5), Coord(30)), 0.5, [](const Coord& at) {
        return 64 + at.x() + 2 * at.y() + 4 * at.z();
    });
    const auto value = [&](const Lattice& lattice, int i, int j, int k) {
        const auto at = lattice.position(Vec3d(i, j, k)) / 0.5;
        return 64 + at.x() + 2 * at.y() + 4 * at.z();
    };
    for (const auto& lattice : {make_box(Vec3d(1.125, 0.5, -1), {7, 5, 3}, 0.5, {0, 1, 2}),
                                make_box(Vec3d(1, 0.5, -1), {7, 5, 3}, 1.0, {2, 1, 0}),
                                make_box(Vec3d(1, 0.5, -1), {7, 5, 3}, 0.3, {1, 0, 2})}) {
        const auto codes = sampled(*grid, lattice);
        for (int k = 0; k < 3; ++k)
            for (int j = 0; j < 5; ++j)
                for (int i = 0; i < 7; ++i)
                    CHECK(decode_energy(codes[static_cast<std::size_t>((k * 5 + j) * 7 + i)]) ==
                          Approx(value(lattice, i, j, k)).epsilon(6e-4));
    }
}

TEST_CASE("a bent lattice's codes are the energy at its vertices, on all sides of the ring") {
    const auto lattice = ring(Vec3d(20.2, 20.4, 8.1), {9, 5, 60}, 1.0, openvdb::Vec2d(-4, -2));
    const auto grid = energy_on(CoordBBox(Coord(0), Coord(40)), 1.0, [](const Coord& at) {
        return 64 + at.x() + 2 * at.y() + 4 * at.z();
    });
    const auto along_u = sampled(*grid, lattice), along_v = sampled(*grid, lattice, Axis::v);
    for (int k = 0; k < 60; ++k)
        for (int j = 0; j < 5; ++j)
            for (int i = 0; i < 9; ++i) {
                const auto& plane = lattice.planes[static_cast<std::size_t>(k)];
                const auto at = plane.origin + i * plane.u + j * plane.v;
                const double energy = 64 + at.x() + 2 * at.y() + 4 * at.z();
                REQUIRE(decode_energy(along_u[static_cast<std::size_t>((k * 5 + j) * 9 + i)]) ==
                        Approx(energy).epsilon(6e-4));
                REQUIRE(along_v[static_cast<std::size_t>((k * 9 + i) * 5 + j)] ==
                        along_u[static_cast<std::size_t>((k * 5 + j) * 9 + i)]);
            }
}

TEST_CASE("an energy that is none is named with its place") {
    const auto lattice = make_box(Vec3d(0), {4, 4, 4}, 0.5, {0, 1, 2});
    const auto grid = energy_on(CoordBBox(Coord(0), Coord(3)), 0.5, [](const Coord& at) {
        return at == Coord(1, 2, 3) ? NAN : at == Coord(2, 2, 3) ? -1.0 : 1.0;
    });
    CHECK(failure_of([&] { sampled(*grid, lattice); }) ==
          "the energy is nan at (0.5, 1, 1.5), vertex (1, 2, 3); energies must be from 0 to "
          "4.29e+09");
    CHECK(failure_of([&] { sampled(*grid, lattice, Axis::v); }) ==
          "the energy is nan at (0.5, 1, 1.5), vertex (1, 2, 3); energies must be from 0 to "
          "4.29e+09");
}

TEST_CASE("frames over the memory budget go to a file that leaves no trace") {
    const Scratch scratch;
    const auto folder = scratch / "work";
    FrameStore(3, 1000, {6000, folder});
    CHECK(!std::filesystem::exists(folder));
    {
        FrameStore store(3, 1000, {100, folder});
        for (std::size_t n = 0; n < 3; ++n)
            for (std::size_t i = 0; i < 1000; ++i) {
                REQUIRE(store.entries(n)[i] == 0);
                store.entries(n)[i] = static_cast<std::uint16_t>(1000 * n + i);
            }
        CHECK(store.entries(2)[999] == 2999);
        CHECK(std::filesystem::is_empty(folder));
    }
    CHECK(failure_of([&] {
              FrameStore(1, 5'000'000, {1, "/proc/nowhere"});
          })
              .starts_with("10.0 MB of energies, seams or displacements exceed the memory budget "
                           "and can't be stored in the work folder"));
}

TEST_CASE("more energy than any memory holds is refused, not wrapped around") {
    CHECK_THROWS_WITH(
        FrameStore(std::size_t{1} << 18, std::size_t{1} << 45),
        "262144 frames of 35184372088832 values each are more than any memory holds; use a coarser "
        "or smaller lattice");
}

TEST_CASE("between voxels, a column sees lone voxels and tiles, and elsewhere the background") {
    for (const float background : {0.0f, 2.0f}) {
        const auto grid = openvdb::FloatGrid::create(background);
        grid->tree().setValue(Coord(30, 21, 3), 7);
        grid->tree().addTile(1, Coord(8, 16, 0), 3, true);
        for (const auto& axes : {std::array{0, 1, 2}, std::array{1, 0, 2}, std::array{2, 1, 0}}) {
            const auto lattice = make_box(Vec3d(-3.3, 0.2, 0.4), {45, 37, 29}, 0.9, axes);
            for (const auto axis : {Axis::u, Axis::v, Axis::w}) {
                const auto codes = sampled(*grid, lattice, axis);
                std::size_t place = 0, wrong = 0, others = 0;
                for (int k = 0; k < lattice.shape[slice_dimension(axis)]; ++k)
                    for (int lateral = 0; lateral < lattice.shape[lateral_dimension(axis)];
                         ++lateral)
                        for (int entry = 0; entry < lattice.shape[dimension(axis)];
                             ++entry, ++place) {
                            const auto at = vertex_of(axis, entry, lateral, k);
                            const auto value = openvdb::tools::BoxSampler::sample(
                                grid->tree(),
                                snapped(lattice.position(Vec3d(at[0], at[1], at[2]))));
                            wrong += codes[place] == encode_energy(value) ? 0 : 1;
                            others += value == background ? 0 : 1;
                        }
                CHECK(wrong == 0);
                CHECK(others > 500);
            }
        }
    }
}
