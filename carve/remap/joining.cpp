#include "carve/remap/joining.h"

#include "carve/base/failure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace fluidcarve {

namespace {

constexpr double soft_of_thin = 3;  ///< vertices

constexpr double soft_of_thickness = 1.4, fade_of_thickness = 1.2;

/// The squeeze follows the seam's surface, but not its steps.
constexpr double across_of_thickness = 0.5;

/// Vertices: a squeeze reaches this far beyond the fade that accompanies it.
constexpr double beside_fade = 3;

Join join_of(const JoinParams& params, bool thick) {
    return params.join.value_or(params.soft            ? Join::squeeze
                                : params.fade || thick ? Join::fade
                                                       : Join::squeeze);
}

}  // namespace

Softness softness_of(const JoinParams& params, const Seams& seams) {
    const int size = seams.before(),
              slabs =
                  static_cast<int>(seams.size() + static_cast<std::size_t>(seams.thickness) - 1) /
                  seams.thickness;
    const double thickness = seams.thickness;
    const auto join = join_of(params, seams.thick());
    if (seams.warp || join == Join::cut) return {};
    if (join == Join::squeeze) {
        // The default is no fault, even in a small lattice.
        if (params.soft && *params.soft > std::max<double>(size, soft_of_thin))
            throw Failure(fmt::format(
                "soft {:g} is wider than the lattice, which has {} vertices along {}; lower it",
                *params.soft, size, to_text(seams.axis)));
        const double reach =
            params.soft.value_or(seams.thick() ? soft_of_thickness * thickness : soft_of_thin);
        return {reach, params.soft_time};
    }
    if (params.fade && *params.fade * slabs > size)
        throw Failure(
            fmt::format("fade {:g} is wider than what lies between two joins: {} {} in {} vertices "
                        "along {} leave {} to each; lower it, or ask for less",
                        *params.fade, slabs, seams.thick() ? "slabs" : "seams", size,
                        to_text(seams.axis), size / std::max(slabs, 1)));
    const double fade = params.fade.value_or(fade_of_thickness * thickness);
    // Joins are as smooth in time as in space.
    return {std::max(soft_of_thickness * thickness, fade / 2 + beside_fade),
            std::max(params.soft_time, 1.0), fade, std::max(2.0, across_of_thickness * thickness)};
}

TimeJoin time_join_of(const JoinParams& params, bool thick) {
    if (params.soft_time > 0)
        throw Failure(
            "`soft_time` has no effect on seams of frames (`axis: t`), whose `soft` is in frames: "
            "leave it out");
    const auto frames = [](double number) { return static_cast<int>(std::lround(number)); };
    switch (join_of(params, thick)) {
        case Join::cut: return {};
        case Join::squeeze: {
            const int soft = frames(params.soft.value_or(soft_of_thin));
            return soft == 0 ? TimeJoin{} : TimeJoin{soft + 1, true};
        }
        case Join::fade: break;
    }
    // Neighbouring frames may blend for long; frames far apart would show as two images at once.
    constexpr double of_thin = 4, of_thick = 2;
    return {frames(params.fade.value_or(thick ? of_thick : of_thin)), false};
}

}  // namespace fluidcarve
