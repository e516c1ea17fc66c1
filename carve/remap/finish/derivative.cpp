#include "carve/remap/finish/derivative.h"

#include <algorithm>
#include <cmath>

namespace fluidcarve {

using openvdb::Mat3d;
using openvdb::Vec3d;

namespace {
/// On the rig of a lattice around it, v has no direction. There the derivative at this distance
/// from the rig is used, vertices.
constexpr double beside_rig = 1e-3;
}  // namespace

Mat3d position_slope(const Mapping& mapping, const Vec3d& at) {
    double plane = std::floor(at.z());
    if (const auto* const slabs = mapping.slabs()) plane = std::min(plane, slabs->size() - 1.0);
    const auto here = mapping.position(at), low = mapping.position({at.x(), at.y(), plane});
    Mat3d out;
    out.setCol(0, mapping.position(at + Vec3d(1, 0, 0)) - here);
    if (const auto polar = mapping.slabs() ? mapping.slabs()->polar() : std::nullopt) {
        // v is perpendicular to u: it has the direction of u a quarter turn further.
        const Vec3d beside(at.x(), at.y() + polar->turn() / 4, at.z()), rig(0, 0, at.z());
        out.setCol(1,
                   2 * M_PI / polar->turn() * (mapping.position(beside) - mapping.position(rig)));
    } else {
        out.setCol(1, mapping.position(at + Vec3d(0, 1, 0)) - here);
    }
    out.setCol(2, mapping.position({at.x(), at.y(), plane + 1}) - low);
    return out;
}

CarveDerivative::CarveDerivative(const Mapping& mapping, const CarveMap& map)
    : mapping_(mapping), map_(map) {
    smooth_.reserve(map.steps().size());
    for (const auto& step : map.steps())
        smooth_.push_back(step.soft() ? *step.soft() : SmoothDisplacement(step));
}

std::optional<CarveDerivative::Image> CarveDerivative::image(const Vec3d& asked) const {
    auto at = asked;
    if (mapping_.slabs() && mapping_.slabs()->polar()) at.x() = std::max(at.x(), beside_rig);
    auto source = at;
    auto slope = Mat3d::identity();
    for (auto n = smooth_.size(); n > 0; --n) {
        const auto& step = map_.steps()[n - 1];
        const int axis = step.axis();
        if (!step.holds(source)) continue;
        if (const auto scale = step.rim_scale(source); !step.carves(source, scale)) {
            if (!step.frees(source)) continue;
            return std::nullopt;
        }
        const auto [d, gradient] = smooth_[n - 1].at(source, step);
        source[axis] += d;
        slope.setRow(axis, slope.row(axis) + slope.transpose() * gradient);
    }
    if (slope == Mat3d::identity() && (source == at || !mapping_.slabs())) return std::nullopt;
    return Image{source, slope,
                 position_slope(mapping_, source) * slope * position_slope(mapping_, at).inverse()};
}

bool CarveDerivative::exact() const {
    return std::ranges::all_of(map_.steps(),
                               [](const CarveStep& step) { return step.soft() != nullptr; });
}

}  // namespace fluidcarve
