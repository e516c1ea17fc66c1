#include "carve/seam/carve_inverse.h"

#include "carve/seam/step_columns.h"

#include <algorithm>
#include <cmath>

namespace fluidcarve {

using openvdb::Vec3d;

double carved_coordinate(const CarveStep& step, const Vec3d& at) {
    const double u = at[step.axis()];
    const bool held = step.holds(at) && u >= step.origin() && u <= step.last_before();
    if (!held || u <= step.first_moved() - 1 || u >= step.last_moved() + 1) return u;
    const StepColumns columns(step, at);
    const double scale = step.rim_scale(at);
    const auto [begin, end] = step.ends(at, scale);
    const auto displaced = [&](int entry) { return scale * columns.displacement(entry); };

    // Find the last entry whose source is not beyond the point.
    int low = scale < 1 ? step.low() : step.start(), high = scale < 1 ? step.high() : step.last();
    const double first = displaced(low), last = displaced(high);
    // A smoothed map continues beyond its ends. Half a vertex beyond them, it meets the ends of the
    // space before.
    const auto beyond = [&](int entry, double d, int before) {
        return entry + 0.5 * (u - entry - d) /
                           std::abs(before - entry - d + (before > entry + d ? 0.5 : -0.5));
    };
    const bool squeezed = step.soft() && scale == 1;
    if (low + first > u) return squeezed ? beyond(low, first, step.origin()) : begin;
    if (high + last <= u)
        return squeezed ? beyond(high, last, step.last_before()) : std::min<double>(high, end);
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        (middle + displaced(middle) <= u ? low : high) = middle;
    }
    const double below = displaced(low), above = displaced(high);
    const double out = below == above ? u - below : low + (u - low - below) / (1 + above - below);
    return squeezed ? out : std::clamp(out, begin, end);
}

Vec3d carved_coordinates(const CarveMap& map, Vec3d at) {
    for (const auto& step : map.steps()) at[step.axis()] = carved_coordinate(step, at);
    return at;
}

}  // namespace fluidcarve
