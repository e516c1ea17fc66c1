#include "carve/mask/sphere.h"

#include "carve/mask/convex.h"

#include <algorithm>

namespace fluidcarve {

MaskGrid::Ptr sphere_mask(const openvdb::GridBase& like, const openvdb::Vec3d& center,
                          double radius) {
    const double reach = radius + convex_slack(like);
    const auto holds = [=](const openvdb::Vec3d& at) {
        return (at - center).lengthSqr() <= reach * reach;
    };
    const auto touches = [=](const openvdb::BBoxd& place) {
        openvdb::Vec3d nearest;
        for (int n = 0; n < 3; ++n)
            nearest[n] = std::clamp(center[n], place.min()[n], place.max()[n]);
        return holds(nearest);
    };
    return convex_mask(
        like,
        {"sphere", openvdb::BBoxd(center - openvdb::Vec3d(reach), center + openvdb::Vec3d(reach)),
         holds, touches});
}

}  // namespace fluidcarve
