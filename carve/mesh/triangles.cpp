#include "carve/mesh/triangles.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace fluidcarve {
namespace {

using openvdb::Vec2d;
using openvdb::Vec3d;

/// Twice the signed area of a triangle, positive if it is counter-clockwise.
double area(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// A corner of the remaining polygon.
struct Corner {
    Vec2d at;
    std::size_t before, after;  ///< neighbours
    bool reflex = false;        ///< reflex or straight: not an ear; only such corners can lie in
                                ///< the triangle of another corner
    std::size_t in_way = 0;     ///< a corner found in its triangle; its own index: none
};

/// Projects a face along the axis in which its area (Newell's method) is largest, so that it is
/// counter-clockwise.
std::vector<Corner> flattened(const std::vector<Vec3d>& points,
                              std::span<const std::uint32_t> face) {
    const auto& first = points[face[0]];
    Vec3d normal(0);
    for (std::size_t n = 1; n + 1 < face.size(); ++n)
        normal += (points[face[n]] - first).cross(points[face[n + 1]] - first);
    int axis = 0;
    for (int c = 1; c < 3; ++c)
        if (std::abs(normal[c]) > std::abs(normal[axis])) axis = c;
    const int x = (axis + 1) % 3, y = (axis + 2) % 3;
    std::vector<Corner> out;
    out.reserve(face.size());
    for (std::size_t n = 0; n < face.size(); ++n) {
        const auto& point = points[face[n]];
        out.push_back({Vec2d(normal[axis] < 0 ? -point[x] : point[x], point[y]),
                       (n + face.size() - 1) % face.size(), (n + 1) % face.size()});
    }
    return out;
}

/// A polygon from which ears are cut.
class EarCut {
public:
    explicit EarCut(std::vector<Corner> ring) : ring_(std::move(ring)) {
        for (std::size_t n = 0; n < ring_.size(); ++n) update(n);
    }

    const Corner& operator[](std::size_t n) const { return ring_[n]; }

    /// The next ear from a corner on. A face without an ear intersects itself: cut anywhere.
    /// @param left  corners
    std::size_t ear_from(std::size_t n, std::size_t left) {
        for (std::size_t tried = 0; tried < left && !is_ear(n); ++tried) n = ring_[n].after;
        return n;
    }
    void cut(std::size_t n) {
        const auto [before, after] = std::pair(ring_[n].before, ring_[n].after);
        if (ring_[n].reflex) std::erase(reflex_, n);
        ring_[n].reflex = false;
        ring_[before].after = after;
        ring_[after].before = before;
        update(before);
        update(after);
    }

private:
    void update(std::size_t n) {
        auto& corner = ring_[n];
        const bool was = corner.reflex;
        corner.reflex = area(ring_[corner.before].at, corner.at, ring_[corner.after].at) <= 0;
        if (corner.reflex && !was) reflex_.push_back(n);
        if (!corner.reflex && was) std::erase(reflex_, n);
        corner.in_way = n;
    }
    bool is_ear(std::size_t n) {
        auto& corner = ring_[n];
        if (corner.reflex) return false;
        if (corner.in_way != n && ring_[corner.in_way].reflex) return false;
        const auto &a = ring_[corner.before].at, &b = corner.at, &c = ring_[corner.after].at;
        const auto found = std::ranges::find_if(reflex_, [&](std::size_t other) {
            const auto& p = ring_[other].at;
            // Ignore corners at the same position as one of the triangle's, as where a hole is
            // joined to the rim.
            return p != a && p != b && p != c && area(a, b, p) >= 0 && area(b, c, p) >= 0 &&
                   area(c, a, p) >= 0;
        });
        corner.in_way = found == reflex_.end() ? n : *found;
        return found == reflex_.end();
    }

    std::vector<Corner> ring_;
    std::vector<std::size_t> reflex_;
};

}  // namespace

void triangulate(const std::vector<Vec3d>& points, std::span<const std::uint32_t> face,
                 std::vector<std::array<std::uint32_t, 3>>& out) {
    out.clear();
    if (face.size() == 3) {
        out.push_back({face[0], face[1], face[2]});
        return;
    }
    EarCut ring(flattened(points, face));
    const auto add = [&](std::size_t n) {
        out.push_back({face[ring[n].before], face[n], face[ring[n].after]});
    };
    std::size_t next = 0;
    for (auto left = face.size(); left > 3; --left) {
        const auto ear = ring.ear_from(next, left);
        add(ear);
        ring.cut(ear);
        // Continue two corners further: fans give thinner triangles than strips.
        next = ring[ring[ear].after].after;
    }
    add(next);
}

}  // namespace fluidcarve
