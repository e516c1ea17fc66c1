#include "carve/mask/box.h"

#include "carve/mask/convex.h"

namespace fluidcarve {

MaskGrid::Ptr box_mask(const openvdb::GridBase& like, const openvdb::Vec3d& min,
                       const openvdb::Vec3d& max) {
    const openvdb::Vec3d slack(convex_slack(like));
    const openvdb::BBoxd box(min - slack, max + slack);
    return convex_mask(like,
                       {"box", box, [box](const openvdb::Vec3d& at) { return box.isInside(at); },
                        [box](const openvdb::BBoxd& place) { return box.hasOverlap(place); }});
}

}  // namespace fluidcarve
