#include "nodes/mask/box.h"

#include "nodes/mask/convex.h"

namespace fluidcarve {
namespace {

struct MaskBox {
    struct Params {
        Vec3 min{}, max{};
    };
    struct Ports {
        Ref<AnyGrid> like;
        Ref<MaskGrid> mask;
    };
    static void check(const Params& params, NodeCheck& check) {
        for (std::size_t n = 0; n < 3; ++n)
            if (params.max[n] < params.min[n])
                check.fault("max", fmt::format("'max' is below 'min' in {}: {:.10g} < {:.10g}", "xyz"[n], params.max[n], params.min[n]));
    }
    static void run(const Params& params, Ports& io, Context&) {
        io.mask = box_mask(*io.like->grid, openvdb::Vec3d(params.min.data()), openvdb::Vec3d(params.max.data()));
    }
};

}  // namespace

MaskGrid::Ptr box_mask(const openvdb::GridBase& like, const openvdb::Vec3d& min, const openvdb::Vec3d& max) {
    const openvdb::Vec3d slack(convex_slack(like));
    const openvdb::BBoxd box(min - slack, max + slack);
    return convex_mask(
        like, {"box", box, [box](const openvdb::Vec3d& at) { return box.isInside(at); }, [box](const openvdb::BBoxd& place) { return box.hasOverlap(place); }});
}

NodeType mask_box() {
    return Declare<MaskBox>("mask.box", "The voxels in a box: where seams are wanted, or kept out.")
        .input("like", &MaskBox::Ports::like, "The mask takes the voxels of this grid, such as the energy. Only its transform counts.")
        .required("min", &MaskBox::Params::min, Unit::world, any_number(), "The low corner.")
        .required("max", &MaskBox::Params::max, Unit::world, any_number(), "The high corner. Both corners lie in the box.")
        .output("mask", &MaskBox::Ports::mask, "The voxels whose centres lie in the box.")
        .kept()
        .in_place();
}

}  // namespace fluidcarve
