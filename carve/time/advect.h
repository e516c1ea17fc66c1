#pragma once

#include <openvdb/openvdb.h>

namespace fluidcarve {

/// Moves a grid by openvdb::tools::VolumeAdvection: by midpoint steps, or with MacCormack's
/// correction, clamped to the neighbouring values.
/// @param motion  world units in a time of 1, along the world's axes
/// @param time    below 0: backwards
/// @return the moved grid, with all voxels that its values reach active
openvdb::FloatGrid::Ptr advected(const openvdb::FloatGrid& grid, const openvdb::Vec3SGrid& motion,
                                 double time, bool mac_cormack);
openvdb::Vec3SGrid::Ptr advected(const openvdb::Vec3SGrid& grid, const openvdb::Vec3SGrid& motion,
                                 double time, bool mac_cormack);

}  // namespace fluidcarve
