#include "nodes/seam/dynamic.h"

#include "graph/text/problem.h"
#include "nodes/seam/cut/cut_seam.h"
#include "nodes/seam/declare_solver.h"
#include "nodes/seam/search/columns.h"
#include "nodes/seam/search/free_line.h"
#include "nodes/seam/search/strip.h"

#include <fmt/format.h>

#include <algorithm>

namespace fluidcarve {

namespace {

bool in_line(const Columns& columns) { return std::max({columns.laterals(), columns.slices(), columns.frames()}) == columns.count(); }

bool closes(const Columns& columns) { return columns.ring(0) || columns.ring(1); }

}  // namespace

bool in_open_line(const EnergyVolume& energy) {
    const Columns columns(energy);
    return in_line(columns) && !closes(columns);
}

Seams::Seam dynamic_seam(const EnergyVolume& energy, Window window, int number, const Tick& tick) {
    const Columns columns(energy);
    if (!in_line(columns))
        throw Failure(fmt::format(
            "seam.dynamic needs columns in one line, as in images, but there are {} x {} x {} columns (lateral, k, frames); use seam.pyramid or seam.graph_cut",
            columns.laterals(), columns.slices(), columns.frames()));
    tick(0);
    if (closes(columns)) return exact_seam(energy, window, number, [&] { tick(0); });
    if (!energy.steps()) return free_line_seam(energy, window, number);

    const auto length = columns.count(), width = static_cast<std::size_t>(window.size());
    const Strip strip(energy, Band::whole(length, window));
    // `[column][entry]`: the step to the column before on the entry's cheapest way. Ties: stay, then this seam's side first.
    std::vector<std::int8_t> steps(length * width);
    const std::array<int, 3> order{0, number % 2 == 0 ? -1 : 1, number % 2 == 0 ? 1 : -1};
    std::vector<double> before(width), now(width);
    const bool in_time = columns.frames() == length;
    for (std::size_t c = 0; c < length; ++c) {
        const auto* const energies = strip.energies(c);
        const auto way = [&](int i, int step) {
            const auto from = static_cast<std::ptrdiff_t>(i) + step;
            return before[static_cast<std::size_t>(from)] + static_cast<double>(strip.steps()(c, window.first + i, c - 1, window.first + i + step, in_time));
        };
        for (int i = 0; i < window.size(); ++i) {
            const auto at = static_cast<std::size_t>(i);
            int best = 0;
            if (c > 0)
                for (const int step : order)
                    if (i + step >= 0 && i + step < window.size() && way(i, step) < way(i, best)) best = step;
            steps[c * width + at] = static_cast<std::int8_t>(best);
            now[at] = energies[at] + (c > 0 ? way(i, best) : 0.0);
        }
        std::swap(before, now);
    }
    auto entry = std::min_element(before.begin(), before.end()) - before.begin();
    const auto least = before[static_cast<std::size_t>(entry)];
    std::vector<std::uint16_t> at(length);
    for (auto c = length; c-- > 0;) {
        at[c] = static_cast<std::uint16_t>(window.first + entry);
        entry += steps[c * width + static_cast<std::size_t>(entry)];
    }
    const auto sum = energy.attracts() ? energy_of(energy, at) : least;
    return {std::move(at), sum, sum};
}

namespace {

struct Dynamic : SeamNode {
    void finish(const Params& params, Ports& io, Context& context) { solve(params, io, context, dynamic_seam); }
};

}  // namespace

NodeType seam_dynamic() {
    Declare<Dynamic> node(
        "seam.dynamic",
        "Finds exact seams of least energy in images, by dynamic programming. For lattices one vertex thick, in one frame or with static seams.");
    return declare_solver(node);
}

}  // namespace fluidcarve
