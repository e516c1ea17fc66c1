#include "nodes/rig/transform.h"

namespace fluidcarve {

using openvdb::Vec3d;

namespace {

struct RigTransform {
    struct Params {
        int smooth = 0;
        double scale = 1;
        Vec3 pivot{};
        Vec3 translate{};
    };
    struct Ports {
        Ref<Rig> rig, transformed;
    };
    static void run(const Params& params, Ports& io, Context&) {
        io.transformed =
            std::make_shared<Rig>(moved(smoothed(*io.rig, params.smooth), params.scale, Vec3d(params.pivot.data()), Vec3d(params.translate.data())));
    }
};

}  // namespace

Rig smoothed(const Rig& rig, int times) {
    auto out = rig;
    if (times > 0) out.oval.reset();
    const auto count = rig.points.size();
    for (; times > 0; --times) {
        const auto from = out.points;
        for (std::size_t n = rig.closed ? 0 : 1; n + (rig.closed ? 0 : 1) < count; ++n)
            out.points[n] = (from[(n + count - 1) % count] + from[n] + from[(n + 1) % count]) / 3.0;
    }
    return out;
}

Rig moved(const Rig& rig, double scale, const Vec3d& pivot, const Vec3d& translate) {
    auto out = rig;
    const auto move = [&](Vec3d& p) { p = pivot + scale * (p - pivot) + translate; };
    for (auto& point : out.points) move(point);
    if (out.oval) {
        move(out.oval->center);
        out.oval->x *= scale;
        out.oval->y *= scale;
    }
    return out;
}

NodeType rig_transform() {
    using Params = RigTransform::Params;
    return Declare<RigTransform>("rig.transform", "Smooths, scales and moves a rig, in this order.")
        .input("rig", &RigTransform::Ports::rig, "The rig.")
        .param("smooth", &Params::smooth, Unit::none, between(0, 1e6),
               "How often each point becomes the mean of itself and its two neighbours. The ends of an open rig stay; a circle shrinks.")
        .param("scale", &Params::scale, Unit::none, between(1e-6, 1e6), "All distances from `pivot` times this.")
        .param("pivot", &Params::pivot, Unit::world, any_number(), "The point that scaling leaves in its place.")
        .param("translate", &Params::translate, Unit::world, any_number(), "How far it is moved, after scaling.")
        .output("rig", &RigTransform::Ports::transformed, "The changed rig.");
}

}  // namespace fluidcarve
