#pragma once

#include "carve/sdf/balls.h"

#include <openvdb/tools/ParticlesToLevelSet.h>

namespace fluidcarve::test {

/// The centres of balls in world units.
struct CentresInWorld {
    using PosType = openvdb::Vec3d;
    const Balls& balls;
    double voxel;
    std::size_t size() const { return balls.centres.size(); }
    void getPos(std::size_t n, openvdb::Vec3d& at) const { at = balls.centres[n] * voxel; }
};

/// What OpenVDB makes of balls, as distances_to_balls().
inline openvdb::FloatTree::Ptr balls_by_openvdb(const Balls& balls, double voxel) {
    auto grid = openvdb::createLevelSet<openvdb::FloatGrid>(voxel, balls.half_width);
    openvdb::tools::ParticlesToLevelSet<openvdb::FloatGrid> raster(*grid);
    raster.setRmin(0);
    raster.setRmax(2 * balls.radius);
    raster.rasterizeSpheres(CentresInWorld{balls, voxel}, balls.radius * voxel);
    raster.finalize(true);
    return grid->treePtr();
}

}  // namespace fluidcarve::test
