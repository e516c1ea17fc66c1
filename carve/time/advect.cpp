// Compiled as C++17, without headers of C++20: TBB's concepts refuse a body of OpenVDB 10 that
// VolumeAdvection uses.

#include "carve/time/advect.h"

#include <openvdb/tools/VolumeAdvect.h>

namespace fluidcarve {
namespace {

template <class GridT>
typename GridT::Ptr moved(const GridT& grid, const openvdb::Vec3SGrid& motion, double time,
                          Transport transport) {
    using namespace openvdb::tools;
    VolumeAdvection<openvdb::Vec3SGrid> advection(motion);
    const bool mac_cormack = transport == Transport::mac_cormack;
    advection.setIntegrator(mac_cormack ? Scheme::MAC : Scheme::MID);
    advection.setLimiter(mac_cormack ? Scheme::CLAMP : Scheme::NO_LIMITER);
    return advection.advect<GridT, BoxSampler>(grid, time);
}

}  // namespace

openvdb::FloatGrid::Ptr advected(const openvdb::FloatGrid& grid, const openvdb::Vec3SGrid& motion,
                                 double time, Transport transport) {
    return moved(grid, motion, time, transport);
}

openvdb::Vec3SGrid::Ptr advected(const openvdb::Vec3SGrid& grid, const openvdb::Vec3SGrid& motion,
                                 double time, Transport transport) {
    return moved(grid, motion, time, transport);
}

}  // namespace fluidcarve
