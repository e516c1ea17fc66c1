#include "nodes/mesh/triangles.h"

#include <algorithm>
#include <cmath>

namespace fluidcarve {
namespace {

using openvdb::Vec2d;
using openvdb::Vec3d;

/// Twice the area of a triangle, positive if it turns to the left.
double area(const Vec2d& a, const Vec2d& b, const Vec2d& c) { return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x()); }

/// The face's corners as seen from above, so that it turns to the left: along the axis in which its area (Newell's) is largest.
std::vector<Vec2d> flattened(const std::vector<Vec3d>& points, std::span<const std::uint32_t> face) {
    Vec3d normal(0);
    for (std::size_t n = 0; n < face.size(); ++n) normal += points[face[n]].cross(points[face[(n + 1) % face.size()]]);
    int axis = 0;
    for (int c = 1; c < 3; ++c)
        if (std::abs(normal[c]) > std::abs(normal[axis])) axis = c;
    const int x = (axis + 1) % 3, y = (axis + 2) % 3;
    std::vector<Vec2d> out;
    for (const auto vertex : face) out.emplace_back(normal[axis] < 0 ? -points[vertex][x] : points[vertex][x], points[vertex][y]);
    return out;
}

}  // namespace

void triangulate(const std::vector<Vec3d>& points, std::span<const std::uint32_t> face, std::vector<std::array<std::uint32_t, 3>>& out) {
    out.clear();
    if (face.size() == 3) {
        out.push_back({face[0], face[1], face[2]});
        return;
    }
    const auto at = flattened(points, face);
    std::vector<std::size_t> left(face.size());
    for (std::size_t n = 0; n < left.size(); ++n) left[n] = n;
    const auto neighbours = [&](std::size_t n) { return std::array{left[(n + left.size() - 1) % left.size()], left[n], left[(n + 1) % left.size()]}; };
    const auto is_ear = [&](std::size_t n) {
        const auto [a, b, c] = neighbours(n);
        if (area(at[a], at[b], at[c]) <= 0) return false;
        return std::none_of(left.begin(), left.end(), [&, a = a, b = b, c = c](std::size_t other) {
            const auto& p = at[other];
            // Corners at one place, as where a hole is joined to the rim, are in nobody's way.
            return p != at[a] && p != at[b] && p != at[c] && area(at[a], at[b], p) >= 0 && area(at[b], at[c], p) >= 0 && area(at[c], at[a], p) >= 0;
        });
    };
    std::size_t next = 0;
    while (left.size() > 3) {
        std::size_t tried = 0;
        while (tried < left.size() && !is_ear((next + tried) % left.size())) ++tried;
        // Without an ear the face meets itself: any cut is as good.
        const auto ear = (next + tried) % left.size();
        const auto [a, b, c] = neighbours(ear);
        out.push_back({face[a], face[b], face[c]});
        left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
        // The corner after the next: fans are thinner than strips.
        next = (ear + 1) % left.size();
    }
    out.push_back({face[left[0]], face[left[1]], face[left[2]]});
}

}  // namespace fluidcarve
