#pragma once

#include <openvdb/openvdb.h>

namespace fluidcarve {

/// How values are moved: back along the motion (openvdb::tools::VolumeAdvection, midpoint steps),
/// or with MacCormack's correction, which is sharper, clamped to the neighbouring values.
enum class Transport { semi_lagrangian, mac_cormack };

/// Moves a grid.
/// @param motion  world units in a time of 1, along the world's axes
/// @param time    below 0: backwards
/// @return the moved grid, with all voxels that its values reach active
openvdb::FloatGrid::Ptr advected(const openvdb::FloatGrid& grid, const openvdb::Vec3SGrid& motion,
                                 double time, Transport transport);
openvdb::Vec3SGrid::Ptr advected(const openvdb::Vec3SGrid& grid, const openvdb::Vec3SGrid& motion,
                                 double time, Transport transport);

}  // namespace fluidcarve
