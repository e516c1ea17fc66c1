#include "nodes/solving/warp_task.h"

#include "carve/solver/task/task.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace fluidcarve {

namespace {

/// Points that a warp is found at, unless its factor is stated.
constexpr auto most_points = std::uint64_t{1} << 26;

}  // namespace

double in_steps(double amount) { return std::round(amount / warp_amount_step) * warp_amount_step; }

bool states_nothing(const WarpParams& params) {
    return params.amount && params.amount->nothing() && !params.rest;
}

SolverParams gathering_params(const WarpParams& params) {
    SolverParams out;
    out.axis = params.axis;
    out.count.value = states_nothing(params) ? 0 : 1;
    out.window = params.window;
    if (params.pair_window) out.pair_window = params.pair_window->above;
    out.anchor = params.anchor;
    return out;
}

Seams empty_warp(const WarpParams& params, const CarvedSpace& space) {
    SeamTask task;
    task.axis = params.axis;
    task.shape = space.shape();
    const int size = task.shape[dimension(params.axis)];
    task.seams.window = window_of(params.window, size);
    if (params.pair_window)
        task.pairs = SeamPart{.window = params.pair_window->above.of(size), .pair = true};
    auto out = empty_seams(gathering_params(params), task, space);
    if (params.pair_window && params.pair_window->below)
        out.pair_below = params.pair_window->below->of(size);
    return out;
}

int warp_factor_for(const WarpParams& params, const Seams& set, std::size_t frames) {
    if (params.factor) return *params.factor;
    for (const int factor : {1, 2}) {
        std::uint64_t points = frames;
        for (const int along : Warp::points_of(set.warp_vertices(), set.warp_rings(), factor))
            points *= static_cast<std::uint64_t>(along);
        if (points <= most_points) return factor;
    }
    return 4;
}

WarpTask warp_task(const WarpParams& params, const WarpAmount& amount, const Seams& set,
                   const Warp& warp) {
    WarpTask out;
    const int size = set.before(), planes = warp.points()[2];
    out.window = window_of(params.window, size);
    out.pair_window = set.pair_window;
    out.pair_below = set.pair_below;
    out.stiffness = {static_cast<double>(params.stiffness),
                     static_cast<double>(params.stiffness_time)};
    std::vector<double> amounts;
    for (std::size_t t = 0; t < warp.frames(); ++t)
        for (int p = 0; p < planes; ++p)
            amounts.push_back(amount.at(place_along(warp.vertex_of(2, p), set.slices(), set.closed),
                                        set.frames[t], size));
    const auto greatest =
        *std::ranges::max_element(amounts, {}, [](double each) { return std::abs(each); });
    out.amount = amount.varies() ? greatest : in_steps(greatest);
    for (const double each : amounts)
        out.factors.push_back(amount.varies() ? static_cast<float>(each / greatest) : 1.0f);
    return out;
}

}  // namespace fluidcarve
