#include "carve/volume/cubes.h"

#include "carve/base/failure.h"
#include "carve/volume/stored_form.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;

TEST_CASE(
    "the least voxels are those that a transform can have, and smaller ones are refused with a "
    "remedy") {
    for (const double edge : {least_voxel, 1.0, 1e9})
        CHECK(cubes_of(edge)->voxelSize() == openvdb::Vec3d(edge));
    for (const double edge : {least_voxel / 2, 0.0, -1.0}) CHECK_THROWS_AS(cubes_of(edge), Failure);
    CHECK_THROWS_WITH(
        cubes_of(1e-6),
        "voxels of 1e-06 world units are too small, 2e-05 is the least; scale the scene");
}

TEST_CASE("a scale that makes voxels too small is told") {
    CHECK_THROWS_WITH(placed(*cubes_of(0.5), Placement{{}, 1e-6}),
                      "with a scale of 1e-06, voxels of 0.5 world units get smaller than 2e-05, "
                      "the least; choose another 'scale'");
}
