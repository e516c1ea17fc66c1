#include "nodes/rig/transform.h"

#include "graph/text/problem.h"

#include <fmt/format.h>

namespace fluidcarve {

using openvdb::Vec3d;

namespace {

struct RigTransform {
    struct Params {
        int smooth = 0;
        double scale = 1;
        Vec3 pivot{};
        Vec3 translate{};
        double extend = 0;
    };
    struct Ports {
        Ref<Rig> rig, transformed;
    };
    static void foresee(const Params& params, Outlook& ahead) {
        const auto* const rig = ahead.region("rig");
        if (!rig) return;
        const auto change = [&](std::vector<Region::Box>& boxes) {
            // Smoothed points stay between the others.
            if (params.smooth > 0 && !boxes.empty()) boxes = {around(boxes)};
            for (auto& box : boxes)
                for (auto* const corner : {&box.low, &box.high})
                    for (std::size_t n = 0; n < 3; ++n) (*corner)[n] = params.pivot[n] + params.scale * ((*corner)[n] - params.pivot[n]) + params.translate[n];
        };
        auto out = *rig;
        change(out.boxes);
        for (auto& other : out.otherwise) change(other.boxes);
        ahead.lies(widened(std::move(out), params.extend));
    }
    static void run(const Params& params, Ports& io, Context&) {
        if (params.extend > 0 && io.rig->closed) throw Failure(fmt::format("{} is closed: it has no ends to 'extend'", text_of(*io.rig)));
        auto rig = moved(smoothed(*io.rig, params.smooth), params.scale, Vec3d(params.pivot.data()), Vec3d(params.translate.data()));
        if (params.extend > 0) rig = extended(rig, params.extend);
        io.transformed = std::make_shared<Rig>(std::move(rig));
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

Rig extended(const Rig& rig, double by) {
    auto out = rig;
    const auto& from = rig.points;
    out.points.insert(out.points.begin(), from.front() + by * (from.front() - from[1]).unit());
    out.points.push_back(from.back() + by * (from.back() - from[from.size() - 2]).unit());
    return out;
}

NodeType rig_transform() {
    using Params = RigTransform::Params;
    return Declare<RigTransform>("rig.transform", "Smooths, scales, moves and extends a rig, in this order.")
        .input("rig", &RigTransform::Ports::rig, "The rig.")
        .param("smooth", &Params::smooth, Unit::none, between(0, 1e6),
               "Number of smoothing steps. In each, every point becomes the mean of itself and its two neighbours. The ends of an open rig stay; a circle "
               "shrinks.")
        .param("scale", &Params::scale, Unit::none, between(1e-6, 1e6), "Factor for all distances from `pivot`.")
        .param("pivot", &Params::pivot, Unit::world, any_number(), "The point that stays in place when the rig is scaled.")
        .param("translate", &Params::translate, Unit::world, any_number(), "Displacement after scaling.")
        .param(
            "extend", &Params::extend, Unit::world, at_least(0),
            "Length by which an open rig is extended straight beyond both ends. Use it if the lattice would end within the smoke: seams tear the smoke there.")
        .output("rig", &RigTransform::Ports::transformed, "The changed rig.");
}

}  // namespace fluidcarve
