#include "carve/remap/finish/finish.h"
#include "carve/remap/grid.h"
#include "carve/seam/carve_map.h"
#include "tests/support/sampled.h"
#include "tests/support/wavy_seams.h"

#include <openvdb/tools/Diagnostics.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <catch2/catch.hpp>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

namespace {

/// A fog that is dense in the middle and nothing outside, with values from 0 to 1.
FloatGrid::Ptr soft_fog() {
    const auto out = FloatGrid::create();
    out->setGridClass(openvdb::GRID_FOG_VOLUME);
    const CoordBBox box({-25, -25, -25}, {25, 25, 25});
    for (auto at = box.begin(); at; ++at) {
        const double value = 1 - (*at).asVec3d().length() / 20 + 0.1 * std::sin((*at)[0]);
        if (value > 0.05) out->tree().setValue(*at, static_cast<float>(std::min(value, 1.0)));
    }
    return out;
}

CarveMap soft_map(const Lattice& lattice, Seams::Kind kind, double soft) {
    Softness softness;
    softness.vertices = soft;
    return {lattice,
            {std::make_shared<const Seams>(wavy_seams(lattice, Axis::u, kind, 28, 8, 2))},
            1,
            std::nullopt,
            std::vector{softness}};
}

}  // namespace

TEST_CASE(
    "OpenVDB's own checks of fogs and level sets pass after a carve as before it, soft or hard, on "
    "the voxels or beside them",
    "[nightly]") {
    const auto ball = openvdb::tools::createLevelSetSphere<FloatGrid>(20, Vec3d(0), 1);
    REQUIRE(openvdb::tools::checkFogVolume(*soft_fog()).empty());
    REQUIRE(openvdb::tools::checkLevelSet(*ball).empty());
    for (const double beside : {0.0, 0.3})
        for (const auto kind : {Seams::Kind::remove, Seams::Kind::insert})
            for (const double soft : {0.0, 3.0}) {
                INFO("soft " << soft << ", " << beside << " voxels beside, "
                             << (kind == Seams::Kind::remove ? "removed" : "inserted"));
                const auto lattice = make_box(Vec3d(-30 + beside), {60, 60, 60}, 1.0, {0, 1, 2});
                const auto map = soft_map(lattice, kind, soft);
                const auto carved = [&](const FloatGrid::Ptr& grid) {
                    const auto source = volume_of(grid);
                    const auto out =
                        finished(source, carve_volume(source, lattice, map, Interpolation::linear),
                                 lattice, map, Finish{});
                    return openvdb::gridConstPtrCast<FloatGrid>(out.grids.front());
                };
                CHECK(openvdb::tools::checkFogVolume(*carved(soft_fog())) == "");
                // Without the slope, the last of nine checks, where whole vertices make cliffs: a
                // distance is no slope of 1 at their edges.
                CHECK(openvdb::tools::checkLevelSet(*carved(ball), soft > 0 ? 9 : 8) == "");
            }
}
