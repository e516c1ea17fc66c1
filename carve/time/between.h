#pragma once

#include "carve/base/values.h"
#include "carve/time/advect.h"
#include "carve/time/points_between.h"
#include "carve/volume/volume.h"

#include <array>
#include <string>
#include <utility>

namespace fluidcarve {

template <>
struct ChoiceNames<Transport> {
    static constexpr std::array names = {std::pair{"semi_lagrangian", Transport::semi_lagrangian},
                                         std::pair{"mac_cormack", Transport::mac_cormack}};
};

/// The volume at a moment between two frames, which may differ from place to place. Floats and
/// vectors of both frames are moved along the motion, and blended by the share; points move along
/// their own velocities, as in points_between(); each voxel of an integer, double or mask grid is
/// that of the nearer frame. A grid that only one frame has fades; if it is a level set, it
/// appears where its frame is the nearer one. A picture's channel moves in its plane, and its rim
/// is repeated beyond. Where the share is 0 or 1, the result is one frame bit for bit, except for
/// level sets beyond their narrow band.
/// @param share   of the way from `a` to `b`
/// @param nearer  `a` or `b`: the result has the grids of this frame
/// @param motion  from `a` to `b`, world units; null: nothing moves
Volume volume_between(const Volume& a, const Volume& b, const ShareAt& share, const Volume& nearer,
                      const VectorGrid* motion, Transport transport);
/// The same with one moment for all places. A float grid that is not a level set is scaled so that
/// its sum is interpolated between those of both frames.
Volume volume_between(const Volume& a, const Volume& b, double share, const VectorGrid* motion,
                      Transport transport);

/// Blends two volumes, by a share of the second that differs from place to place. Points as in
/// points_mixed(); each voxel of an integer, double or mask grid is that of the nearer volume.
/// @param share      of the second
/// @param nearer     `a` or `b`: for content that can't be taken voxel by voxel
/// @param of_points  the same share for points; null: it is the same
Volume volume_mixed(const Volume& a, const Volume& b, const ShareAt& share, const Volume& nearer,
                    const ShareAt& of_points = nullptr);

/// Multiplies velocities by a number, as if time went faster: vector grids called `name`, which
/// may be empty, and the velocities of points.
Volume velocities_scaled(const Volume& volume, const std::string& name, double by);

}  // namespace fluidcarve
