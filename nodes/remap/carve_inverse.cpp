#include "nodes/remap/carve_inverse.h"

#include "nodes/remap/step_columns.h"

#include <algorithm>

namespace fluidcarve {

using openvdb::Vec3d;

double carved_coordinate(const CarveStep& step, const Vec3d& at) {
    const double u = at[step.axis()];
    const bool held = step.holds(at) && u <= step.before() - 1;
    if (!held || u <= step.first_moved() - 1 || (step.paired() && u >= step.last_moved() + 1)) return u;
    const StepColumns columns(step, at[step.lateral_axis()], at.z());
    const double scale = step.scale(at), end = step.end(scale);
    const auto displaced = [&](int entry) { return scale * columns.displacement(entry); };

    // The last entry that does not come from beyond the point.
    int low = 0, high = (scale < 1 ? step.reach() : step.after()) - 1;
    const double first = displaced(low), last = displaced(high);
    if (first > u) return 0;
    if (high + last <= u) return std::min<double>(high, end);
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        (middle + displaced(middle) <= u ? low : high) = middle;
    }
    const double below = displaced(low), above = displaced(high);
    const double out = below == above ? u - below : low + (u - low - below) / (1 + above - below);
    return std::min(out, end);
}

Vec3d carved_coordinates(const CarveMap& map, Vec3d at) {
    for (const auto& step : map.steps()) at[step.axis()] = carved_coordinate(step, at);
    return at;
}

}  // namespace fluidcarve
