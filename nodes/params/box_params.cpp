#include "nodes/params/box_params.h"

#include "nodes/params/check_params.h"

#include <fmt/format.h>

#include <cmath>

namespace fluidcarve {

using openvdb::Vec3d;

namespace {

constexpr int most_steps = most_vertices - 1;

void check_extent(const Vec3& min, const Vec3& max, double spacing, NodeCheck& check) {
    for (std::size_t n = 0; n < 3; ++n) {
        if (!check_corners(min, max, n, check)) continue;
        const double extent = max[n] - min[n], steps = extent / spacing;
        if (steps > most_steps)
            check.fault("max", fmt::format("the extent {:.10g} in {} is {:.0f} times the "
                                           "spacing {:.10g}; {} is the most",
                                           extent, "xyz"[n], steps, spacing, most_steps));
        else if (std::abs(steps - std::round(steps)) > 1e-3)
            check.fault(
                "max",
                fmt::format("the extent {:.10g} in {} is no whole multiple of the spacing "
                            "{:.10g}; the nearest 'max' that fits is {:.10g}",
                            extent, "xyz"[n], spacing, min[n] + std::round(steps) * spacing));
    }
}

/// Steps from the first vertex to the last.
/// @param axis  of the world
double steps_along(const BoxParams& params, std::size_t axis) {
    return std::round(((*params.max)[axis] - (*params.min)[axis]) / *params.spacing);
}

}  // namespace

void check_params(const BoxParams& params, NodeCheck& check) {
    if (check.stated("fit")) {
        for (const auto* field : {"min", "max", "spacing"})
            if (check.stated(field))
                check.fault(field, fmt::format("'{}' and 'fit' exclude each other: a fitted "
                                               "box takes its place and spacing from the grid",
                                               field));
        return;
    }
    for (const auto* field : {"min", "max", "spacing"})
        if (!check.stated(field))
            return check.fault(field, "needs either 'fit', or all of 'min', 'max' and 'spacing'");
    if (!params.min || !params.max || !params.spacing) return;
    if (!(*params.spacing > 0)) return check.fault("spacing", "'spacing' must be above 0");
    check_extent(*params.min, *params.max, *params.spacing, check);
}

std::array<int, 3> axes_of(AxisOrder order) {
    const auto name = ParamTraits<AxisOrder>::text(order);
    return {name[0] - 'x', name[1] - 'x', name[2] - 'x'};
}

std::array<int, 3> in_order(const std::array<int, 3>& axes, const std::array<int, 3>& counts) {
    std::array<int, 3> out;
    for (std::size_t n = 0; n < 3; ++n) out[n] = counts[static_cast<std::size_t>(axes[n])];
    return out;
}

std::array<int, 3> shape_of(const BoxParams& params) {
    std::array<int, 3> counts;
    for (std::size_t n = 0; n < 3; ++n) counts[n] = static_cast<int>(steps_along(params, n)) + 1;
    return in_order(axes_of(params.axes), counts);
}

Lattice stated_box(const BoxParams& params) {
    // The spacing is computed from the corners: a spacing typed with few digits would let the
    // vertices drift away from the voxels.
    double spacing = *params.spacing, longest = 0;
    for (std::size_t n = 0; n < 3; ++n)
        if (const double steps = steps_along(params, n); steps > longest)
            spacing = ((*params.max)[n] - (*params.min)[n]) / (longest = steps);
    return make_box(Vec3d((*params.min)[0], (*params.min)[1], (*params.min)[2]), shape_of(params),
                    spacing, axes_of(params.axes));
}

}  // namespace fluidcarve
