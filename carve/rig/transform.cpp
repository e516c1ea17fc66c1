#include "carve/rig/transform.h"

#include <cstddef>

namespace fluidcarve {

using openvdb::Vec3d;

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

Rig extended(const Rig& rig, double before, double after) {
    auto out = rig;
    const auto& from = rig.points;
    if (before > 0)
        out.points.insert(out.points.begin(),
                          from.front() + before * (from.front() - from[1]).unit());
    if (after > 0)
        out.points.push_back(from.back() + after * (from.back() - from[from.size() - 2]).unit());
    return out;
}

}  // namespace fluidcarve
