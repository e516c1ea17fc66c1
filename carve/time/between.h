#pragma once

#include "carve/base/values.h"
#include "carve/time/points_between.h"
#include "carve/volume/volume.h"

#include <array>
#include <string>
#include <utility>

namespace fluidcarve {

/// How values are moved: straight back along the motion (openvdb::tools::VolumeAdvection, midpoint
/// steps), or with MacCormack's correction, which is sharper, clamped to the values around.
enum class Transport { semi_lagrangian, mac_cormack };
template <>
struct ChoiceNames<Transport> {
    static constexpr std::array names = {std::pair{"semi_lagrangian", Transport::semi_lagrangian},
                                         std::pair{"mac_cormack", Transport::mac_cormack}};
};

/// The volume at a moment between two frames, which may differ from place to place. Numbers and
/// vectors come from both frames, moved along the motion, in the shares of the moment; points go
/// along their own velocities, as points_between(); whole numbers, doubles and masks are those of
/// the nearer frame. A grid that only one frame has fades; a level set is there where its frame is
/// the nearer one. A picture's channel moves in its plane; what lies beyond its rim is what lies
/// there. Where the share is 0 or 1, all is bit for bit that of one frame, but for what of a level
/// set lies beyond its narrow band.
/// @param share   of the way from `a` to `b`
/// @param nearer  `a` or `b`: its grids are those of the result
/// @param motion  from `a` to `b`, world units; null: nothing moves
Volume volume_between(const Volume& a, const Volume& b, const ShareAt& share, const Volume& nearer,
                      const VectorGrid* motion, Transport transport);
/// The same with one moment for all places. A float grid that is no level set sums up to what lies
/// between the sums of both frames.
Volume volume_between(const Volume& a, const Volume& b, double share, const VectorGrid* motion,
                      Transport transport);

/// The volume of two, by a share of the second that differs from place to place. Points as
/// points_mixed(); whole numbers, doubles and masks are those of the nearer one, voxel by voxel.
/// @param share      of the second
/// @param nearer     `a` or `b`: of what can't be taken voxel by voxel
/// @param of_points  the same share for points; null: it is the same
Volume volume_mixed(const Volume& a, const Volume& b, const ShareAt& share, const Volume& nearer,
                    const ShareAt& of_points = nullptr);

/// Multiplies velocities by a number, where time goes faster: the grids of a name, which may be
/// empty, and those of points.
Volume scaled(const Volume& volume, const std::string& name, double by);

}  // namespace fluidcarve
