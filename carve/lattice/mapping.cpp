#include "carve/lattice/mapping.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace fluidcarve {

namespace {

using openvdb::BBoxd;
using openvdb::Vec3d;

template <class Map>
BBoxd around_corners(const BBoxd& box, Map&& map) {
    BBoxd out;
    for (int n = 0; n < 8; ++n)
        out.expand(
            map(Vec3d(n & 1 ? box.max().x() : box.min().x(), n & 2 ? box.max().y() : box.min().y(),
                      n & 4 ? box.max().z() : box.min().z())));
    return out;
}

}  // namespace

Mapping::Mapping(const Lattice& lattice) : Mapping(lattice, lattice.shape) {}

Mapping::Mapping(const Lattice& lattice, const std::array<int, 3>& extent) : extent_(extent) {
    if (!lattice.is_box()) {
        slabs_ = std::make_shared<const Slabs>(lattice, extent);
        return;
    }
    const auto& plane = lattice.planes.front();
    origin_ = plane.origin;
    step_ = {lattice.spacing * plane.u, lattice.spacing * plane.v, lattice.spacing * plane.w};
    for (std::size_t n = 0; n < 3; ++n) {
        const auto across = step_[(n + 1) % 3].cross(step_[(n + 2) % 3]);
        gradient_[n] = across / step_[n].dot(across);
    }
}

Vec3d Mapping::coordinates(const Vec3d& world) const {
    const auto from = world - origin_;
    return {from.dot(gradient_[0]), from.dot(gradient_[1]), from.dot(gradient_[2])};
}

std::optional<Vec3d> Mapping::locate(const Vec3d& world) const {
    if (slabs_) return slabs_->locate(world);
    auto at = coordinates(world);
    for (int n = 0; n < 3; ++n) {
        const double end = extent_[static_cast<std::size_t>(n)] - 1;
        if (!(at[n] >= -rim_slack && at[n] <= end + rim_slack)) return std::nullopt;
        at[n] = std::clamp(snapped(at[n]), 0.0, end);
    }
    return at;
}

BBoxd Mapping::range(const BBoxd& world) const {
    if (slabs_) {
        std::vector<int> candidates;
        return slabs_->candidates(world, candidates);
    }
    return around_corners(world, [&](const Vec3d& corner) { return coordinates(corner); });
}

BBoxd Mapping::world_box(const BBoxd& range) const {
    if (slabs_) return slabs_->world_box(range);
    return around_corners(range, [&](const Vec3d& corner) { return position(corner); });
}

}  // namespace fluidcarve
