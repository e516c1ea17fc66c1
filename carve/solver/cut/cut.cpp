#include "carve/solver/cut/cut.h"

#include "carve/base/failure.h"
#include "carve/solver/cut/cut_region.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numeric>
#include <tuple>
#include <utility>

namespace fluidcarve {

namespace {

/// How many nodes may be visited between two searches, as a share of all nodes.
constexpr double steps_per_search = 1;
constexpr std::size_t most_layers = 16;

std::int64_t steps_between_searches(std::size_t nodes) {
    return static_cast<std::int64_t>(steps_per_search * static_cast<double>(nodes)) + 64;
}

/// Sends as much flow up a column as the column can hold alone.
/// @param costs  of its entries
/// @return the flow that reaches the column's end
inline std::int64_t fill_column(Residual& graph, const Residual::Column& column,
                                const std::vector<std::int32_t>& costs) {
    std::int64_t flow = costs[0];
    for (std::size_t n = 0; n + 1 < costs.size(); ++n) {
        const auto cost = costs[n + 1];
        const auto passed = std::min<std::int64_t>(flow, cost);
        const auto node = column.begin + n;
        graph.arcs[node].excess = flow - passed;
        graph.arcs[node].up =
            cost == Cut::endless ? Cut::endless : static_cast<std::int32_t>(cost - passed);
        graph.tags[node].set_excess(graph.arcs[node].excess > 0);
        graph.tags[node].set_up(graph.arcs[node].up > 0);
        flow = passed;
    }
    return flow;
}

/// Regions that cover all columns side by side: each touches the one before and the one behind.
class Regions {
public:
    Regions(Residual& graph, const std::vector<ColumnBox>& boxes) {
        for (const auto& box : boxes) all_.emplace_back(graph, box, false);
    }

    /// Finds the distances of all nodes.
    void search() {
        each([&](std::size_t n) { all_[n].begin_search(); });
        std::atomic<bool> more = true;
        for (Residual::Label distance = 2; more; ++distance) {
            more = false;
            each([&](std::size_t n) {
                if (all_[n].go_on(distance)) more = true;
            });
            each([&](std::size_t n) {
                if (all_.size() == 1) return;
                if (before(n).empty() && behind(n).empty()) return;
                more = true;
                all_[n].take_reached(before(n), distance);
                all_[n].take_reached(behind(n), distance);
            });
        }
    }
    /// Pushes until nothing is left to push or about `most` nodes were visited.
    template <class Check>
    void push(std::int64_t most, const Check& check) {
        std::vector<std::int64_t> steps(all_.size(), 0);
        bool idle = false;
        while (!idle && std::accumulate(steps.begin(), steps.end(), std::int64_t{0}) < most) {
            check();
            // Regions that touch each other push in turn.
            for (std::size_t parity = 0; parity < 2; ++parity)
                tbb::parallel_for(parity, all_.size(), std::size_t{2}, [&](std::size_t n) {
                    if (all_.size() > 1) {
                        all_[n].take_given(before(n));
                        all_[n].take_given(behind(n));
                    }
                    steps[n] += all_[n].push(steps_between_searches(all_[n].size()) / 8);
                });
            idle = std::ranges::all_of(all_, &CutRegion::idle);
        }
    }

    bool overflowed() const { return std::ranges::any_of(all_, &CutRegion::overflowed); }
    /// Excess that could still reach the sink when the last search ended.
    std::int64_t left() const { return sum(&CutRegion::left); }
    /// Flow that reached the sink.
    std::int64_t sunk() const { return sum(&CutRegion::sunk); }

private:
    template <class Call>
    void each(const Call& call) {
        tbb::parallel_for(std::size_t{0}, all_.size(), call);
    }
    // What the regions beside a region reached in it, or gave to it.
    std::vector<Residual::Spot>& before(std::size_t n) {
        return all_[(n + all_.size() - 1) % all_.size()].sent()[1];
    }
    std::vector<Residual::Spot>& behind(std::size_t n) {
        return all_[(n + 1) % all_.size()].sent()[0];
    }
    std::int64_t sum(std::int64_t (CutRegion::*of)() const) const {
        std::int64_t out = 0;
        for (const auto& region : all_) out += (region.*of)();
        return out;
    }

    std::vector<CutRegion> all_;
};

}  // namespace

Cut::Cut(const Columns& columns, const Band& band, const CostOf& cost_of, const LiftsOf& lifts_of,
         bool reversed)
    : reversed_(reversed), graph_{columns} {
    fill(band, cost_of, lifts_of);
}

void Cut::lifts(std::size_t high, std::size_t low, unsigned direction, int first,
                const LiftsOf& lifts_of, std::span<std::int32_t> out) const {
    const bool in_time = direction / 2 == 2;
    if (!reversed_) return lifts_of(high, low, in_time, first, out);
    // In a reversed cut, the lower column is the higher one.
    lifts_of(low, high, in_time, 0xFFFF - first - static_cast<int>(out.size()), out);
    std::ranges::reverse(out);
}

/// Sets the capacities from a column's nodes to the nodes beside them. Beyond the end of a
/// neighbour's band there is no such node. Only a seam through the entry next to that end makes
/// the step, so this entry's cost rises instead.
void Cut::add_lifts(std::size_t c, const LiftsOf& lifts_of, std::vector<std::int32_t>& costs,
                    std::vector<std::int32_t>& scratch) {
    const auto& column = graph_.columns[c];
    const auto neighbours = graph_.layout.neighbours(c, graph_.layout.place(c));
    const auto add = [&](int entry, std::int32_t lift) {
        auto& cost = costs[static_cast<std::size_t>(entry - column.first)];
        if (cost != endless) cost += lift;
    };
    const auto has = [](const Residual::Column& of, int entry) {
        return entry >= of.first && entry <= of.last;
    };
    std::int32_t one = 0;
    for (unsigned d = 0; d < neighbours.size(); ++d) {
        if (neighbours[d] == Columns::none) continue;
        const auto& other = graph_.columns[neighbours[d]];
        if (has(column, other.last + 1)) {
            lifts(c, neighbours[d], d, other.last, lifts_of, {&one, 1});
            add(other.last + 1, one);
        }
        if (has(column, other.first - 1) && column.last != other.first - 1) {
            lifts(neighbours[d], c, d, other.first - 1, lifts_of, {&one, 1});
            add(other.first - 1, one);
        }
        const int first = std::max(column.first, other.first),
                  last = std::min(column.last, other.last);
        if (first >= last) continue;
        scratch.resize(static_cast<std::size_t>(last - first));
        lifts(c, neighbours[d], d, first, lifts_of, scratch);
        for (std::size_t n = 0; n < scratch.size(); ++n)
            graph_.level[column.begin + static_cast<std::size_t>(first - column.first) + n][d] =
                scratch[n];
    }
}

/// Makes the nodes, with the most flow that each column takes by itself.
void Cut::fill(const Band& band, const CostOf& cost_of, const LiftsOf& lifts_of) {
    graph_.columns.resize(graph_.layout.count());
    std::uint32_t begin = 0;
    for (std::size_t c = 0; c < graph_.columns.size(); ++c) {
        auto [first, last] = band.columns[c];
        if (reversed_)
            std::tie(first, last) = std::pair(static_cast<std::uint16_t>(0xFFFF - last),
                                              static_cast<std::uint16_t>(0xFFFF - first));
        graph_.columns[c] = {begin, first, last};
        begin += static_cast<std::uint32_t>(graph_.columns[c].size());
    }
    graph_.sides.resize(graph_.columns.size());
    graph_.tags.resize(begin);
    graph_.arcs.resize(begin);
    if (lifts_of) graph_.level.resize(begin);
    flow_ = tbb::parallel_deterministic_reduce(
        tbb::blocked_range<std::size_t>(0, graph_.columns.size(), 4096), std::int64_t{0},
        [&](const tbb::blocked_range<std::size_t>& range, std::int64_t sum) {
            std::vector<std::int32_t> costs, scratch;
            for (auto c = range.begin(); c < range.end(); ++c) {
                const auto& column = graph_.columns[c];
                costs.resize(static_cast<std::size_t>(column.size()) + 1);
                cost_of(c, band.columns[c], costs.data());
                if (reversed_) std::ranges::reverse(costs);
                if (lifts_of) add_lifts(c, lifts_of, costs, scratch);
                sum += fill_column(graph_, column, costs);
            }
            return sum;
        },
        std::plus<>());
}

/// Boxes that cover all columns.
/// @param nodes    in each box, about
/// @param shifted  by half of their size
std::vector<ColumnBox> Cut::tiles(std::size_t nodes, bool shifted) const {
    const std::array<std::size_t, 3> sizes{graph_.layout.laterals(), graph_.layout.slices(),
                                           graph_.layout.frames()};
    double columns = static_cast<double>(nodes) * static_cast<double>(graph_.columns.size()) /
                     static_cast<double>(graph_.tags.size());
    std::array<std::size_t, 3> rising{0, 1, 2};
    std::ranges::sort(rising, {}, [&](std::size_t d) { return sizes[d]; });
    std::array<std::vector<std::size_t>, 3> cuts;
    for (std::size_t n = 0; n < 3; ++n) {
        // Boxes are cubes where possible. If a dimension is too short, they are longer along the
        // others.
        const auto d = rising[n];
        const double size = static_cast<double>(sizes[d]),
                     side = std::pow(std::max(columns, 1.0), 1.0 / static_cast<double>(3 - n));
        const auto count = static_cast<std::size_t>(std::max(1.0, std::round(size / side)));
        columns /= size / static_cast<double>(count);
        const bool halves = shifted && count > 1;
        if (halves) cuts[d].push_back(0);
        for (std::size_t m = halves ? 1 : 0; m <= 2 * count; m += 2)
            cuts[d].push_back(sizes[d] * m / (2 * count));
        if (halves) cuts[d].push_back(sizes[d]);
    }
    std::vector<ColumnBox> out;
    for (std::size_t t = 0; t + 1 < cuts[2].size(); ++t)
        for (std::size_t k = 0; k + 1 < cuts[1].size(); ++k)
            for (std::size_t l = 0; l + 1 < cuts[0].size(); ++l)
                out.push_back({{cuts[0][l], cuts[1][k], cuts[2][t]},
                               {cuts[0][l + 1], cuts[1][k + 1], cuts[2][t + 1]}});
    return out;
}

/// Layers along slices or frames, whichever is longer. Each has at least two planes, so that every
/// second one touches no other's nodes.
std::vector<ColumnBox> Cut::layers() const {
    const std::array<std::size_t, 3> sizes{graph_.layout.laterals(), graph_.layout.slices(),
                                           graph_.layout.frames()};
    const std::size_t along = sizes[1] >= sizes[2] ? 1 : 2;
    auto count = std::clamp<std::size_t>(
        std::min(sizes[along] / 2, graph_.tags.size() / tile_nodes), 1, most_layers);
    if (count > 1 && count % 2 != 0) --count;
    std::vector<ColumnBox> out(count, {{0, 0, 0}, sizes});
    for (std::size_t n = 0; n < count; ++n) {
        out[n].begin[along] = sizes[along] * n / count;
        out[n].end[along] = sizes[along] * (n + 1) / count;
    }
    return out;
}

bool Cut::solve_tiles(bool shifted, double tolerance) {
    const auto boxes = tiles(tile_nodes, shifted);
    const double share =
        tolerance * static_cast<double>(flow_) / static_cast<double>(graph_.tags.size());
    std::vector<std::int64_t> sunk(boxes.size());
    std::atomic<bool> overflowed = false;
    tbb::parallel_for(std::size_t{0}, boxes.size(), [&](std::size_t n) {
        CutRegion region(graph_, boxes[n], true);
        while (!region.overflowed()) {
            region.begin_search();
            for (Residual::Label distance = 2; region.go_on(distance); ++distance) {}
            if (static_cast<double>(region.left()) <= share * static_cast<double>(region.size()))
                break;
            region.push(steps_between_searches(region.size()));
        }
        sunk[n] = region.sunk();
        if (region.overflowed()) overflowed = true;
    });
    flow_ += std::accumulate(sunk.begin(), sunk.end(), std::int64_t{0});
    return !overflowed;
}

bool Cut::solve_whole(double tolerance, const std::function<void()>& check) {
    Regions regions(graph_, layers());
    // In a group of tasks of which another one has failed, loops do nothing: the search would never
    // end.
    const auto go_on = [&] {
        check();
        if (tbb::is_current_task_group_canceling()) throw Cancelled{};
    };
    while (true) {
        go_on();
        regions.search();
        left_ = regions.left();
        if (static_cast<double>(left_) <= tolerance * static_cast<double>(flow_)) break;
        regions.push(steps_between_searches(graph_.tags.size()), go_on);
        if (regions.overflowed()) return false;
    }
    flow_ += regions.sunk();
    return true;
}

bool Cut::solve(double tolerance, const std::function<void()>& check) {
    const bool tiled = graph_.tags.size() > most_untiled;
    if (tiled && !(solve_tiles(false, 4 * tolerance) && solve_tiles(true, 2 * tolerance)))
        return false;
    return solve_whole(tolerance, check);
}

std::vector<std::uint16_t> Cut::seam() const {
    std::vector<std::uint16_t> out(graph_.columns.size());
    for (std::size_t c = 0; c < graph_.columns.size(); ++c) {
        const auto& column = graph_.columns[c];
        std::size_t above = 0;
        while (above < static_cast<std::size_t>(column.size()) &&
               graph_.tags[column.begin + above].label() == Residual::far)
            ++above;
        const int entry = column.first + static_cast<int>(above);
        out[c] = static_cast<std::uint16_t>(reversed_ ? 0xFFFF - entry : entry);
    }
    return out;
}

}  // namespace fluidcarve
