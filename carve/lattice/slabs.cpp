#include "carve/lattice/slabs.h"

#include "carve/base/failure.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace fluidcarve {

using openvdb::BBoxd;
using openvdb::Vec3d;

namespace {

constexpr std::size_t group_size = 16;
/// Allowance for rounding, vertices.
constexpr double hair = 1e-9;

/// Half the range of a linear function over a box.
/// @param half  half the box's size
double variation(const Vec3d& gradient, const Vec3d& half) {
    return std::abs(gradient.x()) * half.x() + std::abs(gradient.y()) * half.y() +
           std::abs(gradient.z()) * half.z();
}

void expand(BBoxd& box, double by) {
    box.min() -= Vec3d(by);
    box.max() += Vec3d(by);
}

}  // namespace

Slabs::Slabs(const Lattice& lattice, const std::array<int, 3>& extent)
    : closed_(lattice.closed),
      closed_form_(lattice.closed_form),
      polar_(lattice.around ? std::optional<Polar>(lattice.shape[1]) : std::nullopt),
      size_(static_cast<int>(lattice.planes.size()) - (lattice.closed ? 0 : 1)),
      open_slack_(lattice.closed ? 0 : rim_slack),
      spacing_(lattice.spacing),
      last_u_(lattice.shape[0] - 1),
      last_v_(lattice.shape[1] - 1),
      end_u_(extent[0] - 1),
      end_v_(extent[1] - 1),
      end_w_(size_) {
    const auto& planes = lattice.planes;
    const std::size_t least = closed_ ? 3 : 2;
    if (planes.size() < least)
        throw Failure(fmt::format("the lattice ({}) has {} {}; {} needs at least {}",
                                  lattice.description, planes.size(),
                                  planes.size() == 1 ? "plane" : "planes",
                                  closed_ ? "a closed one" : "one that is no straight box", least));
    const double hand = planes[0].u.cross(planes[0].v).dot(planes[0].w) < 0 ? -1 : 1;
    const auto count = static_cast<std::size_t>(size_);
    slabs_.reserve(count);
    for (std::size_t k = 0; k < count; ++k)
        slabs_.emplace_back(planes[k], planes[(k + 1) % planes.size()], spacing_, hand);

    const auto divider = [](const Slab& slab, double c) {
        return Divider{slab.normal(c), slab.origin(c)};
    };
    for (int k = 0; k < size(); ++k) dividers_.push_back(divider((*this)[k], from(k)));
    dividers_.push_back(closed_ ? dividers_.front() : divider(slabs_.back(), to(size() - 1)));

    for (int k = 0; k < size(); ++k) {
        bounds_.push_back(bounds_of(k));
        if (static_cast<std::size_t>(k) % group_size == 0) groups_.emplace_back();
        groups_.back().expand(bounds_.back().box);
    }
}

Slabs::Bounds Slabs::bounds_of(int k) const {
    const auto& slab = (*this)[k];
    const auto u = slab.step_u(0), v = slab.step_v(0), normal = slab.normal(0);
    const double hand = u.cross(v).dot(normal) < 0 ? -1 : 1, square = normal.lengthSqr();
    Bounds out{{}, hand * v.cross(normal) / square, hand * normal.cross(u) / square, 0, 0};
    const auto rims = across();
    for (int n = 0; n < 4; ++n) {
        const double a = (n & 1 ? rims.max() : rims.min()).x(),
                     b = (n & 2 ? rims.max() : rims.min()).y();
        for (const double c : {from(k), to(k)}) {
            const auto corner = slab.position(a, b, c);
            out.box.expand(corner);
            const auto off = corner - slab.position(a, b, 0);
            out.error_u = std::max(out.error_u, std::abs(out.gradient_u.dot(off)));
            out.error_v = std::max(out.error_v, std::abs(out.gradient_v.dot(off)));
        }
    }
    expand(out.box, hair * spacing_);
    out.error_u += hair;
    out.error_v += hair;
    return out;
}

template <class Visit>
void Slabs::each(const BBoxd& world, Visit&& visit) const {
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        if (!groups_[g].hasOverlap(world)) continue;
        const auto end = std::min(slabs_.size(), (g + 1) * group_size);
        for (auto k = g * group_size; k < end; ++k)
            if (bounds_[k].box.hasOverlap(world) && !visit(static_cast<int>(k))) return;
    }
}

Vec3d Slabs::position(const Vec3d& at) const {
    const auto across = polar_ ? polar_->across(at.x(), at.y()) : openvdb::Vec2d(at.x(), at.y());
    const double below = std::floor(at.z());
    if (!closed_) {
        const double k = std::clamp(below, 0.0, static_cast<double>(size() - 1));
        return slabs_[static_cast<std::size_t>(k)].position(across.x(), across.y(), at.z() - k);
    }
    const auto k = static_cast<std::size_t>(below - size() * std::floor(below / size()));
    return slabs_[k].position(across.x(), across.y(), at.z() - below);
}

BBoxd Slabs::across() const {
    if (!polar_)
        return {Vec3d(-rim_slack, -rim_slack, 0), Vec3d(end_u_ + rim_slack, end_v_ + rim_slack, 0)};
    const double radius = end_u_ + rim_slack;
    return {Vec3d(-radius, -radius, 0), Vec3d(radius, radius, 0)};
}

bool Slabs::beside(const BBoxd& box) const {
    if (polar_) return around(box).min().x() > end_u_ + rim_slack;
    return box.max().x() < -rim_slack || box.min().x() > end_u_ + rim_slack ||
           box.max().y() < -rim_slack || box.min().y() > end_v_ + rim_slack;
}

BBoxd Slabs::around(const BBoxd& box) const {
    const auto nearest = [](double low, double high) { return std::max({low, -high, 0.0}); };
    const auto farthest = [](double low, double high) {
        return std::max(std::abs(low), std::abs(high));
    };
    const auto distance = [&](const auto& of) {
        return std::hypot(of(box.min().x(), box.max().x()), of(box.min().y(), box.max().y()));
    };
    BBoxd out({distance(nearest), 0, box.min().z()},
              {distance(farthest), polar_->turn(), box.max().z()});
    if (out.min().x() <= hair) return out;
    // A box beside the rig is less than half a turn wide.
    const auto middle = 0.5 * (box.min() + box.max());
    const double turn = polar_->turn(), v = polar_->around(middle.x(), middle.y()).y();
    double low = 0, high = 0;
    for (int n = 0; n < 4; ++n) {
        const double off =
            polar_->around((n & 1 ? box.max() : box.min()).x(), (n & 2 ? box.max() : box.min()).y())
                .y() -
            v;
        const double nearer = off - turn * std::round(off / turn);
        low = std::min(low, nearer);
        high = std::max(high, nearer);
    }
    const double first = v + low - hair, whole = turn * std::floor(first / turn);
    out.min().y() = first - whole;
    out.max().y() = v + high + hair - whole;
    return out;
}

std::optional<Vec3d> Slabs::locate(const Vec3d& world) const {
    std::optional<Vec3d> found;
    each({world, world}, [&](int k) {
        if (!(divider(k).side(world) >= 0 && divider(k + 1).side(world) < 0)) return true;
        const auto& slab = (*this)[k];
        Vec3d at;
        const auto holds = settle(k,
                                  closed_form_ ? slab.solve_closed_form(world)
                                               : slab.solve(slab.products(world), from(k), to(k)),
                                  at);
        if (holds == Holds::yes || (holds == Holds::beyond && !found)) found = at;
        return holds != Holds::yes;
    });
    return found;
}

Slabs::Holds Slabs::settle_around(const Vec3d& solved, double w, Vec3d& at) const {
    const auto place = polar_->around(solved.x(), solved.y());
    if (!within(place.x(), end_u_)) return Holds::no;
    const double u = std::min(snapped(place.x()), end_u_), v = snapped(place.y());
    at = {u, u > 0 && v < polar_->turn() ? v : 0, w};
    return u <= last_u_ ? Holds::yes : Holds::beyond;
}

BBoxd Slabs::candidates(const BBoxd& world, std::vector<int>& slabs) const {
    slabs.clear();
    BBoxd range;
    const auto centre = 0.5 * (world.min() + world.max()), half = 0.5 * (world.max() - world.min());
    const double rounding = hair * spacing_ * spacing_ * spacing_;
    each(world, [&](int k) {
        const auto &low = divider(k), &high = divider(k + 1);
        if (low.side(centre) + variation(low.normal, half) < -rounding ||
            high.side(centre) - variation(high.normal, half) > rounding)
            return true;
        const auto& bounds = bounds_[static_cast<std::size_t>(k)];
        const auto from_origin = centre - (*this)[k].origin();
        const double u = bounds.gradient_u.dot(from_origin), v = bounds.gradient_v.dot(from_origin);
        const double by_u = variation(bounds.gradient_u, half) + bounds.error_u,
                     by_v = variation(bounds.gradient_v, half) + bounds.error_v;
        const BBoxd found({u - by_u, v - by_v, static_cast<double>(k)},
                          {u + by_u, v + by_v, static_cast<double>(k + 1)});
        if (beside(found)) return true;
        range.expand(found);
        slabs.push_back(k);
        return true;
    });
    if (slabs.empty()) return range;
    if (polar_) range = around(range);
    if (!closed_) return range;

    // The range is the shortest arc of the ring: it leaves out the widest gap.
    int widest = slabs.front() + size() - slabs.back();
    for (std::size_t n = 1; n < slabs.size(); ++n)
        if (slabs[n] - slabs[n - 1] > widest) {
            widest = slabs[n] - slabs[n - 1];
            range.min().z() = slabs[n];
            range.max().z() = slabs[n - 1] + 1 + size();
        }
    return range;
}

BBoxd Slabs::world_box(const BBoxd& range) const {
    BBoxd out;
    const auto corner = [&](int n, double w) -> Vec3d {
        if (polar_)
            return position({M_SQRT2 * range.max().x(), polar_->turn() * (2 * n + 1) / 8, w});
        return position({n & 1 ? range.max().x() : range.min().x(),
                         n & 2 ? range.max().y() : range.min().y(), w});
    };
    const auto add = [&](double w) {
        for (int n = 0; n < 4; ++n) out.expand(corner(n, w));
    };
    add(range.min().z());
    for (double w = std::floor(range.min().z()) + 1; w < range.max().z(); ++w) add(w);
    add(range.max().z());
    return out;
}

}  // namespace fluidcarve
