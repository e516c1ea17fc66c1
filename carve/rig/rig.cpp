#include "carve/rig/rig.h"

#include "carve/base/words.h"

#include <fmt/format.h>
#include <openvdb/math/BBox.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace fluidcarve {

using openvdb::Vec3d;

namespace {
constexpr int oval_points = 720;
}

Vec3d Rig::Oval::at(double a) const { return center + std::cos(a) * x + std::sin(a) * y; }

Rig oval_rig(const Rig::Oval& oval, const Vec3d& up) {
    Rig out;
    for (int n = 0; n < oval_points; ++n)
        out.points.push_back(oval.at(oval.start + 2 * M_PI * n / oval_points));
    out.closed = true;
    out.up = up;
    out.oval = oval;
    return out;
}

std::string rig_fault(const Rig& rig) {
    const auto& points = rig.points;
    const std::size_t least = rig.closed ? 3 : 2, count = points.size();
    if (count < least)
        return fmt::format("a {}rig needs at least {} points, not {}", rig.closed ? "closed " : "",
                           least, count);
    const auto chords = rig.closed ? count : count - 1;
    const auto chord = [&](std::size_t n) { return points[(n + 1) % count] - points[n % count]; };
    for (std::size_t n = 0; n < chords; ++n)
        if (chord(n).length() == 0)
            return fmt::format(
                "points {} and {} of the rig are the same, {}{}", n + 1, (n + 1) % count + 1,
                to_text(points[n]),
                n + 1 == count ? "; a closed rig returns to its first point by itself" : "");
    for (std::size_t n = rig.closed ? 0 : 1; n < chords; ++n)
        // The rig turns straight back, within half a degree.
        if (const auto before = chord(n + count - 1), after = chord(n);
            before.dot(after) < -0.99996 * before.length() * after.length())
            return fmt::format("the rig turns right back at point {}, {}", n + 1,
                               to_text(points[n]));
    return {};
}

Region region_of(const Rig& rig) {
    constexpr std::size_t most_boxes = 256;
    const auto count = rig.points.size(), lines = rig.closed || count < 2 ? count : count - 1,
               in_a_row = lines / most_boxes + 1;
    Region out;
    for (std::size_t first = 0; first < lines; first += in_a_row) {
        openvdb::BBoxd box;
        for (auto n = first; n <= std::min(first + in_a_row, lines); ++n)
            box.expand(rig.points[n % count]);
        out.boxes.push_back({{box.min().x(), box.min().y(), box.min().z()},
                             {box.max().x(), box.max().y(), box.max().z()}});
    }
    return out;
}

std::string to_text(const Vec3d& position) { return fmt::format("({})", numbers_text(position)); }

std::string to_text(const Rig& rig) {
    if (rig.oval) {
        const double x = rig.oval->x.length(), y = rig.oval->y.length();
        if (std::abs(x - y) <= 1e-12 * x)
            return fmt::format("a circle of radius {:g} around {}", x, to_text(rig.oval->center));
        return fmt::format("an oval of radii {:g} and {:g} around {}", x, y,
                           to_text(rig.oval->center));
    }
    if (rig.closed)
        return fmt::format("a closed path of {} points through {}", rig.points.size(),
                           to_text(rig.points.front()));
    return fmt::format("an open path of {} points from {} to {}", rig.points.size(),
                       to_text(rig.points.front()), to_text(rig.points.back()));
}

}  // namespace fluidcarve
