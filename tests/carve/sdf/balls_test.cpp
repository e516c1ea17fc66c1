#include "carve/sdf/balls.h"
#include "tests/support/balls_by_openvdb.h"
#include "tests/support/grid_bytes.h"

#include <tbb/task_arena.h>
#include <catch2/catch.hpp>

#include <random>
#include <vector>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Vec3d;

namespace {

constexpr double voxel = 0.25;

std::vector<Vec3d> random_points(std::size_t count, double size) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> at(-size, size);
    std::vector<Vec3d> out;
    for (std::size_t n = 0; n < count; ++n) out.emplace_back(at(random), at(random), at(random));
    return out;
}

}  // namespace

TEST_CASE("distances to balls are those of OpenVDB's ParticlesToLevelSet, bit for bit") {
    struct Case {
        std::size_t count;
        double size, radius, half_width;
    };
    // Few and many; small and large; balls thicker than the band, whose inside is one value.
    for (const auto& [count, size, radius, half_width] :
         {Case{1, 3, 1.5, 3}, Case{2000, 12, 1.4, 3}, Case{300, 40, 0.5, 2}, Case{20, 20, 9.5, 2.5},
          Case{3, 30, 30, 4}, Case{4, 9, 2, 20}}) {
        INFO(count << " balls of radius " << radius << ", band " << half_width);
        const auto centres = random_points(count, size);
        const Balls balls{centres, radius, half_width};
        const auto made = distances_to_balls(balls, voxel);
        CHECK(made->activeVoxelCount() > 50);
        CHECK(bytes(*made) == bytes(*balls_by_openvdb(balls, voxel)));
        tbb::task_arena one(1);
        one.execute([&] { CHECK(bytes(*distances_to_balls(balls, voxel)) == bytes(*made)); });
    }
    CHECK(distances_to_balls({{}, 1, 3}, voxel)->empty());
}
