#include "nodes/mask/sphere.h"

#include "nodes/mask/convex.h"

#include <algorithm>

namespace fluidcarve {
namespace {

struct MaskSphere {
    struct Params {
        Vec3 center{};
        double radius = 0;
    };
    struct Ports {
        Ref<AnyGrid> like;
        Ref<MaskGrid> mask;
    };
    static void run(const Params& params, Ports& io, Context&) { io.mask = sphere_mask(*io.like->grid, openvdb::Vec3d(params.center.data()), params.radius); }
};

}  // namespace

MaskGrid::Ptr sphere_mask(const openvdb::GridBase& like, const openvdb::Vec3d& center, double radius) {
    const double reach = radius + convex_slack(like);
    const auto holds = [=](const openvdb::Vec3d& at) { return (at - center).lengthSqr() <= reach * reach; };
    const auto touches = [=](const openvdb::BBoxd& place) {
        openvdb::Vec3d nearest;
        for (int n = 0; n < 3; ++n) nearest[n] = std::clamp(center[n], place.min()[n], place.max()[n]);
        return holds(nearest);
    };
    return convex_mask(like, {"sphere", openvdb::BBoxd(center - openvdb::Vec3d(reach), center + openvdb::Vec3d(reach)), holds, touches});
}

NodeType mask_sphere() {
    return Declare<MaskSphere>("mask.sphere", "The voxels in a sphere: where seams are wanted, or kept out.")
        .input("like", &MaskSphere::Ports::like, "The mask takes the voxels of this grid, such as the energy. Only its transform counts.")
        .required("center", &MaskSphere::Params::center, Unit::world, any_number(), "Centre of the sphere.")
        .required("radius", &MaskSphere::Params::radius, Unit::world, at_least(0), "Radius of the sphere; its border lies in it.")
        .output("mask", &MaskSphere::Ports::mask, "The voxels whose centres lie in the sphere.")
        .kept()
        .in_place();
}

}  // namespace fluidcarve
