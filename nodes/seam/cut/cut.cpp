#include "nodes/seam/cut/cut.h"

#include "graph/text/problem.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <functional>
#include <numeric>
#include <tuple>

namespace fluidcarve {

namespace {

/// How many nodes may be visited between two searches, as a share of all nodes.
constexpr double steps_per_search = 1;
constexpr std::size_t most_layers = 16;

std::int64_t steps_between_searches(std::size_t nodes) { return static_cast<std::int64_t>(steps_per_search * static_cast<double>(nodes)) + 64; }

}  // namespace

Cut::Cut(const Columns& columns, const Band& band, const CostOf& cost_of, const LiftsOf& lifts_of, bool reversed) : columns_(columns), reversed_(reversed) {
    fill(band, cost_of, lifts_of);
}

void Cut::lifts(std::size_t high, std::size_t low, unsigned direction, int first, const LiftsOf& lifts_of, std::span<std::int32_t> out) const {
    const bool in_time = direction / 2 == 2;
    if (!reversed_) return lifts_of(high, low, in_time, first, out);
    // In a reversed cut, the lower column is the higher one.
    lifts_of(low, high, in_time, 0xFFFF - first - static_cast<int>(out.size()), out);
    std::ranges::reverse(out);
}

/// Sets the capacities from a column's nodes to those beside them. Where a neighbour's band ends, there is no such node. Only a seam
/// through the entry next to that end makes the step, so this entry's cost rises instead.
void Cut::add_lifts(std::size_t c, const LiftsOf& lifts_of, std::vector<std::int32_t>& costs, std::vector<std::int32_t>& scratch) {
    const auto& column = column_[c];
    const auto around = columns_.around(c, columns_.place(c));
    const auto add = [&](int entry, std::int32_t lift) {
        auto& cost = costs[static_cast<std::size_t>(entry - column.first)];
        if (cost != endless) cost += lift;
    };
    const auto has = [](const Column& of, int entry) { return entry >= of.first && entry <= of.last; };
    std::int32_t one = 0;
    for (unsigned d = 0; d < around.size(); ++d) {
        if (around[d] == Columns::none) continue;
        const auto& other = column_[around[d]];
        if (has(column, other.last + 1)) {
            lifts(c, around[d], d, other.last, lifts_of, {&one, 1});
            add(other.last + 1, one);
        }
        if (has(column, other.first - 1) && column.last != other.first - 1) {
            lifts(around[d], c, d, other.first - 1, lifts_of, {&one, 1});
            add(other.first - 1, one);
        }
        const int first = std::max(column.first, other.first), last = std::min(column.last, other.last);
        if (first >= last) continue;
        scratch.resize(static_cast<std::size_t>(last - first));
        lifts(c, around[d], d, first, lifts_of, scratch);
        for (std::size_t n = 0; n < scratch.size(); ++n) level_[column.begin + static_cast<std::size_t>(first - column.first) + n][d] = scratch[n];
    }
}

/// Makes the nodes, with as much flow up each column as it takes by itself.
void Cut::fill(const Band& band, const CostOf& cost_of, const LiftsOf& lifts_of) {
    column_.resize(columns_.count());
    std::uint32_t begin = 0;
    for (std::size_t c = 0; c < column_.size(); ++c) {
        auto [first, last] = band.columns[c];
        if (reversed_) std::tie(first, last) = std::pair(static_cast<std::uint16_t>(0xFFFF - last), static_cast<std::uint16_t>(0xFFFF - first));
        column_[c] = {begin, first, last};
        begin += static_cast<std::uint32_t>(column_[c].size());
    }
    sides_.resize(column_.size());
    tags_.resize(begin);
    excess_.resize(begin);
    arcs_.resize(begin);
    if (lifts_of) level_.resize(begin);
    flow_ = tbb::parallel_deterministic_reduce(
        tbb::blocked_range<std::size_t>(0, column_.size(), 4096), std::int64_t{0},
        [&](const tbb::blocked_range<std::size_t>& range, std::int64_t sum) {
            std::vector<std::int32_t> costs, scratch;
            for (auto c = range.begin(); c < range.end(); ++c) {
                const auto& column = column_[c];
                costs.resize(static_cast<std::size_t>(column.size()) + 1);
                cost_of(c, band.columns[c], costs.data());
                if (reversed_) std::reverse(costs.begin(), costs.end());
                if (lifts_of) add_lifts(c, lifts_of, costs, scratch);
                std::int64_t flow = costs[0];
                for (std::size_t n = 0; n + 1 < costs.size(); ++n) {
                    const auto cost = costs[n + 1];
                    const auto passed = std::min<std::int64_t>(flow, cost);
                    const auto node = column.begin + n;
                    excess_[node] = flow - passed;
                    arcs_[node].up = cost == endless ? endless : static_cast<std::int32_t>(cost - passed);
                    tags_[node].set_excess(excess_[node] > 0);
                    tags_[node].set_up(arcs_[node].up > 0);
                    flow = passed;
                }
                sum += flow;
            }
            return sum;
        },
        std::plus<>());
}

/// Pushes flow through a part of the columns.
class Cut::Region {
public:
    /// @param walled  true: as if there were no other columns; false: columns outside get flow too, but push it themselves
    Region(Cut& cut, const Box& box, bool walled) : cut_(cut), box_(box) {
        const auto& all = cut.columns_;
        const std::array<std::size_t, 3> size{all.laterals(), all.slices(), all.frames()};
        const std::array<std::size_t, 3> stride{1, all.laterals(), all.per_frame()};
        for (std::size_t d = 0; d < 3; ++d) {
            const auto step = static_cast<std::ptrdiff_t>(stride[d]), around = step * (static_cast<std::ptrdiff_t>(size[d]) - 1);
            step_[2 * d] = -step;
            step_[2 * d + 1] = step;
            step_[2 * d + wrapped] = around;
            step_[2 * d + 1 + wrapped] = -around;
        }
        for_each_column([&](std::size_t c, const std::array<std::size_t, 3>& at) {
            size_ += static_cast<std::size_t>(cut_.column_[c].size());
            unsigned sides = 0;
            for (unsigned d = 0; d < 3; ++d) {
                const bool whole = box.low[d] == 0 && box.high[d] == size[d], ring = all.ring(d);
                for (unsigned ahead = 0; ahead < 2; ++ahead) {
                    const bool rim = at[d] == (ahead ? size[d] - 1 : 0), edge = at[d] == (ahead ? box.high[d] - 1 : box.low[d]);
                    if ((rim && !ring) || (edge && walled && !(ring && whole))) continue;
                    sides |= 1u << (2 * d + ahead);
                    if (rim) sides |= 1u << (closing + 2 * d + ahead);
                    if (edge && !whole) sides |= 1u << (leaving + ahead);
                }
                if (!whole) along_ = d;
            }
            cut_.sides_[c] = static_cast<std::uint16_t>(sides);
        });
    }

    std::size_t size() const { return size_; }
    /// Whether it has nothing left to push, and gave nothing to other regions.
    bool idle() const { return active_.empty() && sent_[0].empty() && sent_[1].empty(); }
    /// Flow that reached the sink.
    std::int64_t sunk() const { return sunk_; }
    /// Whether more flow gathered than an arc holds.
    bool overflowed() const { return overflowed_; }
    /// Excess that could still reach the sink when the last search ended.
    std::int64_t left() const { return left_; }
    /// Nodes of the regions before and behind that were reached or given flow.
    std::array<std::vector<Spot>, 2>& sent() { return sent_; }

    /// Resets all distances but those of nodes next to the sink.
    void begin_search() {
        for (auto* const list : {&front_, &active_, &sent_[0], &sent_[1]}) list->clear();
        left_ = 0;
        for_each_column([&](std::size_t c, const auto&) {
            const auto& column = cut_.column_[c];
            if (column.size() == 0) return;
            const auto end = column.begin + static_cast<std::uint32_t>(column.size());
            for (auto n = column.begin; n < end; ++n) cut_.tags_[n].set_label(far);
            if (cut_.tags_[end - 1].up()) reach({static_cast<std::uint32_t>(c), column.last}, end - 1, 1, front_);
        });
    }
    // Flattened, as discharge() is: g++ would call the lambdas in it, which is slower.
    /// Extends the search by one arc.
    /// @return whether it reached any node
    [[gnu::flatten]] bool go_on(Label distance) {
        next_.clear();
        for (const auto& spot : front_) {
            const auto c = spot.column;
            const int entry = spot.entry;
            const auto& column = cut_.column_[c];
            const auto own = node(column, entry);
            const auto tag = cut_.tags_[own];
            if (entry - 1 > column.first && cut_.tags_[own - 1].up()) reach({c, lower(entry)}, own - 1, distance, next_);
            if (entry < column.last) reach({c, higher(entry)}, own + 1, distance, next_);
            for_each_side(c, [&](std::size_t other, unsigned d, int out) {
                const auto to = static_cast<std::uint32_t>(other);
                const auto& beside = cut_.column_[other];
                const auto go = [&](std::uint16_t at, std::uint32_t n) {
                    if (out < 0) reach({to, at}, n, distance, next_);
                    else sent_[static_cast<std::size_t>(out)].push_back({to, at});
                };
                if (const auto above = node(beside, entry + 1); above != none) go(higher(entry), above);
                if (tag.lowered(d)) go(lower(entry), node(beside, entry - 1));
                if (cut_.level_.empty()) return;
                if (const auto level = node(beside, entry); level != none && cut_.level_[level][Columns::back(d)] > 0) go(spot.entry, level);
            });
        }
        std::swap(front_, next_);
        return !front_.empty();
    }
    /// Adds nodes that other regions reached.
    void take_reached(std::vector<Spot>& spots, Label distance) {
        for (const auto& spot : spots) reach(spot, node(cut_.column_[spot.column], spot.entry), distance, front_);
        spots.clear();
    }

    /// Pushes until nothing is left to push or `most` nodes were visited.
    /// @return number of visited nodes
    std::int64_t push(std::int64_t most) {
        std::int64_t steps = 0;
        while (!active_.empty() && steps < most) {
            next_.clear();
            for (const auto& spot : active_) steps += discharge(spot);
            std::swap(active_, next_);
        }
        return steps;
    }
    void take_given(std::vector<Spot>& spots) {
        active_.insert(active_.end(), spots.begin(), spots.end());
        spots.clear();
    }

private:
    // closing, leaving: bits of Cut::sides_ behind those of the directions. wrapped: where step_ holds the steps across the closing.
    static constexpr unsigned closing = 6, leaving = 10, wrapped = 6;

    static std::uint16_t higher(int entry) { return static_cast<std::uint16_t>(entry + 1); }
    static std::uint16_t lower(int entry) { return static_cast<std::uint16_t>(entry - 1); }

    template <class Call>
    void for_each_column(const Call& call) {
        for (auto t = box_.low[2]; t < box_.high[2]; ++t)
            for (auto k = box_.low[1]; k < box_.high[1]; ++k) {
                const auto first = cut_.columns_.at(0, k, t);
                for (auto lateral = box_.low[0]; lateral < box_.high[0]; ++lateral) call(first + lateral, std::array{lateral, k, t});
            }
    }
    /// @param call  called with the neighbour, the direction to it, and -1 if it is inside, 0 if it belongs to the region before, 1 if to
    ///   the one behind
    template <class Call>
    void for_each_side(std::uint32_t c, const Call& call) {
        const unsigned sides = cut_.sides_[c];
        for (unsigned rest = sides & 63; rest != 0; rest &= rest - 1) {
            const auto d = static_cast<unsigned>(std::countr_zero(rest));
            const bool across = d < 4 && (sides >> (closing + d) & 1), leaves = d / 2 == along_ && (sides >> (leaving + d % 2) & 1);
            call(static_cast<std::size_t>(static_cast<std::ptrdiff_t>(c) + step_[across ? d + wrapped : d]), d, leaves ? static_cast<int>(d % 2) : -1);
        }
    }

    void reach(const Spot& spot, std::uint32_t n, Label distance, std::vector<Spot>& out) {
        auto& tag = cut_.tags_[n];
        if (tag.label() != far) return;
        tag.set_label(distance);
        out.push_back(spot);
        if (!tag.excess()) return;
        left_ += cut_.excess_[n];
        active_.push_back(spot);
    }

    /// Pushes a node's excess on to nodes nearer to the sink, and raises the node's distance if some is left.
    /// @return number of visits of the node
    [[gnu::flatten]] int discharge(const Spot& spot) {
        const auto c = spot.column;
        const int entry = spot.entry;
        const auto& column = cut_.column_[c];
        const auto own = node(column, entry);
        auto& tag = cut_.tags_[own];
        auto& arcs = cut_.arcs_[own];
        auto excess = cut_.excess_[own];
        auto label = tag.label();
        if (excess == 0 || label == far) return 1;
        const auto give = [&](std::uint32_t n, std::size_t to, std::uint16_t at, int out, std::int64_t amount) {
            auto& other = cut_.tags_[n];
            if (!other.excess()) (out < 0 ? next_ : sent_[static_cast<std::size_t>(out)]).push_back({static_cast<std::uint32_t>(to), at});
            other.set_excess(true);
            cut_.excess_[n] += amount;
            excess -= amount;
        };
        for (int steps = 1;; ++steps) {
            // The least distance among nodes at the ends of arcs with residual capacity.
            auto nearest = far;
            if (arcs.up > 0) {
                const bool last = entry == column.last;
                const Label above = last ? 0 : cut_.tags_[own + 1].label();
                if (above + 1 == label) {
                    const auto amount = arcs.up == endless ? excess : std::min<std::int64_t>(excess, arcs.up);
                    if (arcs.up != endless) arcs.up -= static_cast<std::int32_t>(amount);
                    if (last) {
                        sunk_ += amount;
                        excess -= amount;
                    } else {
                        give(own + 1, c, higher(entry), -1, amount);
                    }
                }
                if (arcs.up > 0) nearest = above;
            }
            if (excess > 0)
                for_each_side(c, [&](std::size_t other, unsigned d, int out) {
                    if (excess == 0) return;
                    const auto& beside = cut_.column_[other];
                    if (const auto above = node(beside, entry + 1); above != none && cut_.tags_[above].lowered(Columns::back(d))) {
                        const auto at = cut_.tags_[above].label();
                        auto& lowered = cut_.arcs_[above].lowered[Columns::back(d)];
                        if (at + 1 == label) {
                            const auto amount = std::min<std::int64_t>(excess, lowered);
                            lowered -= static_cast<std::int32_t>(amount);
                            if (lowered == 0) cut_.tags_[above].set_lowered(Columns::back(d), false);
                            give(above, other, higher(entry), out, amount);
                        }
                        if (lowered > 0) nearest = std::min(nearest, at);
                    }
                    if (const auto level = cut_.level_.empty() ? none : node(beside, entry); level != none && cut_.level_[own][d] > 0) {
                        const auto at = cut_.tags_[level].label();
                        auto& through = cut_.level_[own][d];
                        if (at + 1 == label && excess > 0) {
                            const auto amount = std::min<std::int64_t>(excess, through);
                            through -= static_cast<std::int32_t>(amount);
                            cut_.level_[level][Columns::back(d)] += static_cast<std::int32_t>(amount);
                            give(level, other, spot.entry, out, amount);
                        }
                        if (through > 0) nearest = std::min(nearest, at);
                    }
                    if (const auto below = node(beside, entry - 1); below != none) {
                        const auto at = cut_.tags_[below].label();
                        auto& lowered = arcs.lowered[d];
                        if (at + 1 == label && excess > 0) {
                            const auto amount = std::min<std::int64_t>(excess, endless - lowered);
                            overflowed_ = overflowed_ || amount < excess;
                            lowered += static_cast<std::int32_t>(amount);
                            tag.set_lowered(d, true);
                            give(below, other, lower(entry), out, amount);
                        }
                        if (lowered < endless) nearest = std::min(nearest, at);
                    }
                });
            if (excess > 0 && entry - 1 > column.first) {
                const auto at = cut_.tags_[own - 1].label();
                if (at + 1 == label) {
                    auto& up = cut_.arcs_[own - 1].up;
                    const auto amount = up == endless ? excess : std::min<std::int64_t>(excess, endless - 1 - up);
                    overflowed_ = overflowed_ || amount < excess;
                    if (up != endless) up += static_cast<std::int32_t>(amount);
                    cut_.tags_[own - 1].set_up(true);
                    give(own - 1, c, lower(entry), -1, amount);
                }
                nearest = std::min(nearest, at);
            }
            if (excess > 0) label = nearest == far ? far : nearest + 1;
            if (excess > 0 && label != far) continue;
            tag.set_label(label);
            tag.set_up(arcs.up > 0);
            tag.set_excess(excess > 0);
            cut_.excess_[own] = excess;
            return steps;
        }
    }

    Cut& cut_;
    const Box box_;
    std::array<std::ptrdiff_t, 12> step_;
    unsigned along_ = 0;  ///< the dimension in which the columns before and behind the box belong to other regions
    std::size_t size_ = 0;
    std::int64_t sunk_ = 0, left_ = 0;
    bool overflowed_ = false;
    std::vector<Spot> front_, next_, active_;
    std::array<std::vector<Spot>, 2> sent_;
};

/// Boxes that cover all columns.
/// @param nodes    in each box, about
/// @param shifted  by half of their size
std::vector<Cut::Box> Cut::tiles(std::size_t nodes, bool shifted) const {
    const std::array<std::size_t, 3> sizes{columns_.laterals(), columns_.slices(), columns_.frames()};
    double columns = static_cast<double>(nodes) * static_cast<double>(column_.size()) / static_cast<double>(tags_.size());
    std::array<std::size_t, 3> rising{0, 1, 2};
    std::ranges::sort(rising, {}, [&](std::size_t d) { return sizes[d]; });
    std::array<std::vector<std::size_t>, 3> cuts;
    for (std::size_t n = 0; n < 3; ++n) {
        // Boxes are equally long in all dimensions. If a dimension is too short, they are longer along the others.
        const auto d = rising[n];
        const double size = static_cast<double>(sizes[d]), side = std::pow(std::max(columns, 1.0), 1.0 / static_cast<double>(3 - n));
        const auto count = static_cast<std::size_t>(std::max(1.0, std::round(size / side)));
        columns /= size / static_cast<double>(count);
        const bool halves = shifted && count > 1;
        if (halves) cuts[d].push_back(0);
        for (std::size_t m = halves ? 1 : 0; m <= 2 * count; m += 2) cuts[d].push_back(sizes[d] * m / (2 * count));
        if (halves) cuts[d].push_back(sizes[d]);
    }
    std::vector<Box> out;
    for (std::size_t t = 0; t + 1 < cuts[2].size(); ++t)
        for (std::size_t k = 0; k + 1 < cuts[1].size(); ++k)
            for (std::size_t l = 0; l + 1 < cuts[0].size(); ++l)
                out.push_back({{cuts[0][l], cuts[1][k], cuts[2][t]}, {cuts[0][l + 1], cuts[1][k + 1], cuts[2][t + 1]}});
    return out;
}

/// Layers along k or t, whichever is longer. Each has at least two planes, so that every second one touches no other's nodes.
std::vector<Cut::Box> Cut::layers() const {
    const std::array<std::size_t, 3> sizes{columns_.laterals(), columns_.slices(), columns_.frames()};
    const std::size_t along = sizes[1] >= sizes[2] ? 1 : 2;
    auto count = std::clamp<std::size_t>(std::min(sizes[along] / 2, tags_.size() / tile_nodes), 1, most_layers);
    if (count > 1 && count % 2 != 0) --count;
    std::vector<Box> out(count, {{0, 0, 0}, sizes});
    for (std::size_t n = 0; n < count; ++n) {
        out[n].low[along] = sizes[along] * n / count;
        out[n].high[along] = sizes[along] * (n + 1) / count;
    }
    return out;
}

bool Cut::solve_tiles(bool shifted, double tolerance) {
    const auto boxes = tiles(tile_nodes, shifted);
    const double share = tolerance * static_cast<double>(flow_) / static_cast<double>(tags_.size());
    std::vector<std::int64_t> sunk(boxes.size());
    std::atomic<bool> overflowed = false;
    tbb::parallel_for(std::size_t{0}, boxes.size(), [&](std::size_t n) {
        Region region(*this, boxes[n], true);
        while (!region.overflowed()) {
            region.begin_search();
            for (Label distance = 2; region.go_on(distance); ++distance) {}
            if (static_cast<double>(region.left()) <= share * static_cast<double>(region.size())) break;
            region.push(steps_between_searches(region.size()));
        }
        sunk[n] = region.sunk();
        if (region.overflowed()) overflowed = true;
    });
    flow_ += std::accumulate(sunk.begin(), sunk.end(), std::int64_t{0});
    return !overflowed;
}

bool Cut::solve_whole(double tolerance, const std::function<void()>& tick) {
    std::vector<Region> regions;
    for (const auto& box : layers()) regions.emplace_back(*this, box, false);
    const auto count = regions.size();
    const auto each = [&](const auto& call) { tbb::parallel_for(std::size_t{0}, count, call); };
    const auto before = [&](std::size_t n) -> std::vector<Spot>& { return regions[(n + count - 1) % count].sent()[1]; };
    const auto behind = [&](std::size_t n) -> std::vector<Spot>& { return regions[(n + 1) % count].sent()[0]; };
    // In a group of tasks of which another one has failed, loops do nothing: the search would never end.
    const auto go_on = [&] {
        tick();
        if (tbb::is_current_task_group_canceling()) throw Cancelled{};
    };
    while (true) {
        go_on();
        each([&](std::size_t n) { regions[n].begin_search(); });
        std::atomic<bool> more = true;
        for (Label distance = 2; more; ++distance) {
            more = false;
            each([&](std::size_t n) {
                if (regions[n].go_on(distance)) more = true;
            });
            each([&](std::size_t n) {
                if (count == 1) return;
                if (before(n).empty() && behind(n).empty()) return;
                more = true;
                regions[n].take_reached(before(n), distance);
                regions[n].take_reached(behind(n), distance);
            });
        }
        left_ = 0;
        for (const auto& region : regions) left_ += region.left();
        if (static_cast<double>(left_) <= tolerance * static_cast<double>(flow_)) break;
        const auto most = steps_between_searches(tags_.size());
        std::vector<std::int64_t> steps(count, 0);
        bool idle = false;
        while (!idle && std::accumulate(steps.begin(), steps.end(), std::int64_t{0}) < most) {
            go_on();
            for (std::size_t parity = 0; parity < 2; ++parity)
                tbb::parallel_for(parity, count, std::size_t{2}, [&](std::size_t n) {
                    if (count > 1) {
                        regions[n].take_given(before(n));
                        regions[n].take_given(behind(n));
                    }
                    steps[n] += regions[n].push(steps_between_searches(regions[n].size()) / 8);
                });
            idle = std::ranges::all_of(regions, [](const Region& region) { return region.idle(); });
        }
        if (std::ranges::any_of(regions, [](const Region& region) { return region.overflowed(); })) return false;
    }
    for (const auto& region : regions) flow_ += region.sunk();
    return true;
}

bool Cut::solve(double tolerance, const std::function<void()>& tick) {
    const bool tiled = tags_.size() > most_untiled;
    if (tiled && !(solve_tiles(false, 4 * tolerance) && solve_tiles(true, 2 * tolerance))) return false;
    return solve_whole(tolerance, tick);
}

std::vector<std::uint16_t> Cut::seam() const {
    std::vector<std::uint16_t> out(column_.size());
    for (std::size_t c = 0; c < column_.size(); ++c) {
        const auto& column = column_[c];
        std::size_t above = 0;
        while (above < static_cast<std::size_t>(column.size()) && tags_[column.begin + above].label() == far) ++above;
        const int entry = column.first + static_cast<int>(above);
        out[c] = static_cast<std::uint16_t>(reversed_ ? 0xFFFF - entry : entry);
    }
    return out;
}

}  // namespace fluidcarve
