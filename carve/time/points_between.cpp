#include "carve/time/points_between.h"

#include "carve/base/unit_hash.h"
#include "carve/field/extent.h"
#include "carve/points/point_grid.h"
#include "carve/points/point_vectors.h"
#include "carve/time/scale_search.h"

#include <openvdb/math/BBox.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

namespace fluidcarve {
namespace {

using openvdb::Vec3d;

/// The points of a frame, with velocities and ids.
struct Cloud {
    std::vector<Vec3d> at;
    std::vector<Vec3d> velocity;                             ///< empty: unknown
    std::vector<std::pair<std::uint64_t, std::size_t>> ids;  ///< id and point, rising; empty: none

    Cloud(const Points& points, const std::string& name)
        : at(points.positions()), velocity(vectors_of(points, name)) {
        for (auto& each : velocity)
            if (!openvdb::math::isFinite(each)) each = Vec3d(0);
        if (!points.has_ids()) return;
        const auto identities = points.identities();
        for (std::size_t n = 0; n < identities.size(); ++n) ids.emplace_back(identities[n], n);
        std::ranges::sort(ids);
    }
    /// Displacement of a point from frame to frame, world units.
    Vec3d motion(std::size_t n, double scale) const {
        return velocity.empty() ? Vec3d(0) : scale * velocity[n];
    }
};

/// Calls `both(in a, in b)` for points of the same id, and `one(point, whether of a, id)` for
/// others, by rising ids.
template <class Both, class One>
void each_id(const Cloud& a, const Cloud& b, const Both& both, const One& one) {
    auto x = a.ids.begin(), y = b.ids.begin();
    while (x != a.ids.end() || y != b.ids.end())
        if (y == b.ids.end() || (x != a.ids.end() && x->first < y->first)) {
            one(x->second, true, x->first);
            ++x;
        } else if (x == a.ids.end() || y->first < x->first) {
            one(y->second, false, y->first);
            ++y;
        } else both((x++)->second, (y++)->second);
}

/// A position on the curve from `a` to `b` that begins and ends with the motions `from` and `to`.
/// If these lead elsewhere, the curve is a straight line.
Vec3d on_the_way(const Vec3d& a, const Vec3d& b, const Vec3d& from, const Vec3d& to, double share) {
    const auto way = b - a;
    const auto straight = a + share * way;
    if ((way - 0.5 * (from + to)).length() > 0.5 * way.length()) return straight;
    const double t = share, rest = 1 - t;
    return a + t * t * (3 - 2 * t) * way + t * rest * (rest * from - t * to);
}

/// Points by the cell that they are in, to find the one nearest to a place.
class Cells {
public:
    explicit Cells(const std::vector<Vec3d>& at) : at_(at) {
        openvdb::BBoxd box;
        for (const auto& each : at) box.expand(each);
        const auto size = box.extents();
        const auto count = std::cbrt(static_cast<double>(at.size()));
        cell_ = std::cbrt(size.x() * size.y() * size.z()) / count;
        if (!(cell_ > 0)) cell_ = std::max({size.x(), size.y(), size.z()}) / count;
        if (!(cell_ > 0)) return;
        // The box is mostly empty: the spacing follows from the cells with points.
        sort();
        spacing_ = cell_ * std::cbrt(static_cast<double>(cells_.size())) / count;
        cell_ = 2 * spacing_;
        sort();
    }
    /// Typical distance of neighbours, world units; 0: all points are in one place.
    double spacing() const { return spacing_; }
    /// Distance to the nearest point, at most two spacings.
    double nearest(const Vec3d& place) const {
        double out = cell_ * cell_;
        const auto middle = cell_of(place);
        for (auto cell = openvdb::CoordBBox(middle.offsetBy(-1), middle.offsetBy(1)).begin(); cell;
             ++cell) {
            const auto found = cells_.find(*cell);
            if (found == cells_.end()) continue;
            for (const auto n : found->second) out = std::min(out, (at_[n] - place).lengthSqr());
        }
        return std::sqrt(out);
    }

private:
    void sort() {
        cells_.clear();
        for (std::size_t n = 0; n < at_.size(); ++n) cells_[cell_of(at_[n])].push_back(n);
    }
    openvdb::Coord cell_of(const Vec3d& place) const {
        return openvdb::Coord::floor(near_place(place / cell_));
    }

    const std::vector<Vec3d>& at_;
    double cell_ = 0, spacing_ = 0;
    std::unordered_map<openvdb::Coord, std::vector<std::size_t>> cells_;
};

/// The scale at which points of `a`, moved, come nearest to points of `b`.
double scale_without_ids(const Cloud& a, const Cloud& b) {
    double sum = 0;
    for (const auto& velocity : a.velocity) sum += velocity.lengthSqr();
    if (sum == 0 || b.at.empty()) return 0;
    const double speed = std::sqrt(sum / static_cast<double>(a.velocity.size()));
    const Cells cells(b.at);
    if (!(cells.spacing() > 0)) return 0;
    // Enough points for a reliable answer.
    constexpr std::size_t enough = 4000;
    const auto step = std::max<std::size_t>(a.at.size() / enough, 1);
    return cells.spacing() / speed * least_error_at([&](double number) {
               double out = 0;
               for (std::size_t n = 0; n < a.at.size(); n += step)
                   out += std::pow(
                       cells.nearest(a.at[n] + a.motion(n, number * cells.spacing() / speed)), 2);
               return out;
           });
}

/// Finds the points at a moment between two frames.
class Between {
public:
    Between(const Points& a, const Points& b, const ShareAt& share, const PointMotion& motion)
        : a_(a, motion.velocity),
          b_(b, motion.velocity),
          share_(share),
          scale_(motion.scale),
          velocities_{vectors_of(a, motion.velocity), vectors_of(b, motion.velocity)} {}

    bool have_ids() const { return !a_.ids.empty() && !b_.ids.empty(); }
    const std::vector<PointImage>& images() const { return images_; }
    /// Velocities of the points of `a`, or of `b`, as they are shown.
    const std::vector<Vec3d>& velocities(bool of_a) const { return velocities_[of_a ? 0 : 1]; }

    /// A point of both frames moves from its one position to the other; others appear or vanish
    /// one by one.
    void by_ids() {
        each_id(
            a_, b_,
            [&](std::size_t x, std::size_t y) {
                const double share = share_(a_.at[x]);
                const bool first = share < 0.5;
                show(first ? x : y, first,
                     share == 0   ? a_.at[x]
                     : share == 1 ? b_.at[y]
                                  : on_the_way(a_.at[x], b_.at[y], a_.motion(x, scale_),
                                               b_.motion(y, scale_), share));
                if (!a_.velocity.empty() && !b_.velocity.empty() && share > 0 && share < 1)
                    velocities_[first ? 0 : 1][first ? x : y] =
                        (1 - share) * a_.velocity[x] + share * b_.velocity[y];
            },
            [&](std::size_t n, bool of_a, std::uint64_t id) {
                if (of_a == (share_of(n, of_a) < unit_hash(id))) show(n, of_a, moved(n, of_a));
            });
        std::ranges::sort(images_, std::less<>(), &PointImage::source);
    }

    /// Shows all points of one frame.
    void all_of(bool a) {
        for (std::size_t n = 0; n < (a ? a_ : b_).at.size(); ++n) show(n, a, moved(n, a));
    }

    /// Shows the points of the nearer frame, and those of the other where the first leave a gap;
    /// but none where neither frame has points, so that inflow and outflow keep their ends.
    void without_ids() {
        for (const bool of_a : {true, false})
            for (std::size_t n = 0; n < (of_a ? a_ : b_).at.size(); ++n)
                if ((share_of(n, of_a) < 0.5) == of_a) show(n, of_a, moved(n, of_a));
        if (a_.at.empty() || b_.at.empty()) return;
        const Cells a(a_.at), b(b_.at);
        const auto beyond = [&](const Vec3d& at, double near) {
            return a.nearest(at) > near && b.nearest(at) > near;
        };
        std::erase_if(images_, [&](const PointImage& image) {
            return beyond(image.position, (image.source < a_.at.size() ? a : b).spacing());
        });
        std::vector<Vec3d> held;
        for (const auto& image : images_) held.push_back(image.position);
        if (held.empty()) return;
        const Cells there(held);
        for (const bool of_a : {true, false})
            for (std::size_t n = 0; n < (of_a ? a_ : b_).at.size(); ++n) {
                const double share = share_of(n, of_a), near = (of_a ? b : a).spacing();
                if ((share < 0.5) == of_a || share == 0 || share == 1) continue;
                if (const auto at = moved(n, of_a); there.nearest(at) > near && !beyond(at, near))
                    show(n, of_a, at);
            }
        std::ranges::sort(images_, std::less<>(), &PointImage::source);
    }

private:
    double share_of(std::size_t n, bool of_a) const { return share_((of_a ? a_ : b_).at[n]); }
    /// Points of `b` are numbered after those of `a`.
    void show(std::size_t n, bool of_a, const Vec3d& at) {
        images_.push_back({static_cast<std::uint32_t>((of_a ? 0 : a_.at.size()) + n), true, at});
    }
    Vec3d moved(std::size_t n, bool of_a) const {
        const double share = share_of(n, of_a);
        return of_a ? a_.at[n] + share * a_.motion(n, scale_)
                    : b_.at[n] - (1 - share) * b_.motion(n, scale_);
    }

    Cloud a_, b_;
    const ShareAt& share_;
    double scale_;
    std::array<std::vector<Vec3d>, 2> velocities_;
    std::vector<PointImage> images_;
};

}  // namespace

Points points_in(const VolumeGrid& grid) {
    require_sound(*grid.grid(), "the source");
    Points out;
    out.grid = grid.grid();
    return out;
}

double point_scale(const Points& a, const Points& b, const std::string& velocity) {
    const Cloud from(a, velocity), to(b, velocity);
    if (from.velocity.empty() || to.velocity.empty()) return 0;
    if (from.ids.empty() || to.ids.empty()) return scale_without_ids(from, to);
    double along = 0, square = 0;
    each_id(
        from, to,
        [&](std::size_t x, std::size_t y) {
            const auto mean = 0.5 * (from.velocity[x] + to.velocity[y]);
            along += mean.dot(to.at[y] - from.at[x]);
            square += mean.lengthSqr();
        },
        [](std::size_t, bool, std::uint64_t) {});
    return square > 0 ? along / square : 0;
}

Points points_mixed(const Points& a, const Points& b, const ShareAt& share, const Points& nearer) {
    if (!alike(a, b)) return nearer;
    std::vector<PointImage> images;
    const auto shown = [&](std::uint64_t id, const Vec3d& at) { return share(at) > unit_hash(id); };
    const auto at = a.positions(), next = b.positions();
    const auto ids = a.identities(), next_ids = b.identities();
    std::unordered_map<std::uint64_t, bool> second;  // whether a point of `a` changed to `b`, by
                                                     // id
    const bool known = a.has_ids() && b.has_ids();
    for (std::size_t n = 0; n < at.size(); ++n) {
        const bool of_b = shown(ids[n], at[n]);
        if (known) second.emplace(ids[n], of_b);
        if (!of_b) images.push_back({static_cast<std::uint32_t>(n), false, at[n]});
    }
    const auto of_a = images.size();
    for (std::size_t n = 0; n < next.size(); ++n) {
        const auto held = second.find(next_ids[n]);
        if (held != second.end() ? held->second : shown(next_ids[n], next[n]))
            images.push_back({static_cast<std::uint32_t>(a.size() + n), true, next[n]});
    }
    const auto of_b = images.size() - of_a;
    if (of_a == a.size() && of_b == 0) return a;
    if (of_a == 0 && of_b == b.size()) return b;
    return with_images(a, images, &b);
}

Points points_between(const Points& a, const Points& b, const ShareAt& share, const Points& nearer,
                      const PointMotion& motion) {
    Between between(a, b, share, motion);
    const bool first = &nearer == &a;
    if (!alike(a, b)) {
        between.all_of(first);
        auto images = between.images();
        for (auto& image : images) image.source -= static_cast<std::uint32_t>(first ? 0 : a.size());
        return with_images(nearer, images);
    }
    if (between.have_ids()) between.by_ids();
    else between.without_ids();
    const auto shown = [&](const Points& points, bool of_a) {
        const auto& velocities = between.velocities(of_a);
        return velocities.empty() ? points : with_vectors(points, motion.velocity, velocities);
    };
    const auto from = shown(a, true), to = shown(b, false);
    return with_images(from, between.images(), &to);
}

Points points_between(const Points& a, const Points& b, double share, const PointMotion& motion) {
    return points_between(
        a, b, [share](const Vec3d&) { return share; }, share < 0.5 ? a : b, motion);
}

}  // namespace fluidcarve
