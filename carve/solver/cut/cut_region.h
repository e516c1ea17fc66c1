#pragma once

#include "carve/solver/cut/residual.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace fluidcarve {

/// Pushes flow through a part of the columns.
class CutRegion {
public:
    using Label = Residual::Label;
    using Spot = Residual::Spot;

    /// @param walled  true: as if there were no other columns; false: columns outside get flow too,
    ///   but push it themselves
    CutRegion(Residual& graph, const ColumnBox& box, bool walled) : graph_(graph), box_(box) {
        const auto& all = graph.layout;
        const std::array<std::size_t, 3> size{all.laterals(), all.slices(), all.frames()};
        const std::array<std::size_t, 3> stride{1, all.laterals(), all.per_frame()};
        for (std::size_t d = 0; d < 3; ++d) {
            const auto step = static_cast<std::ptrdiff_t>(stride[d]),
                       around = step * (static_cast<std::ptrdiff_t>(size[d]) - 1);
            step_[2 * d] = -step;
            step_[2 * d + 1] = step;
            step_[2 * d + wrapped] = around;
            step_[2 * d + 1 + wrapped] = -around;
        }
        for_each_column([&](std::size_t c, const std::array<std::size_t, 3>& at) {
            size_ += static_cast<std::size_t>(graph_.columns[c].size());
            unsigned sides = 0;
            for (unsigned d = 0; d < 3; ++d) {
                const bool whole = box.begin[d] == 0 && box.end[d] == size[d], ring = all.ring(d);
                for (unsigned ahead = 0; ahead < 2; ++ahead) {
                    const bool rim = at[d] == (ahead ? size[d] - 1 : 0),
                               edge = at[d] == (ahead ? box.end[d] - 1 : box.begin[d]);
                    if ((rim && !ring) || (edge && walled && !(ring && whole))) continue;
                    sides |= 1u << (2 * d + ahead);
                    if (rim) sides |= 1u << (closing + 2 * d + ahead);
                    if (edge && !whole) sides |= 1u << (leaving + ahead);
                }
                if (!whole) along_ = d;
            }
            graph_.sides[c] = static_cast<std::uint16_t>(sides);
        });
    }

    std::size_t size() const { return size_; }
    /// Whether no excess is left to push, and none was given to other regions.
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
            const auto& column = graph_.columns[c];
            if (column.size() == 0) return;
            const auto end = column.begin + static_cast<std::uint32_t>(column.size());
            for (auto n = column.begin; n < end; ++n) graph_.tags[n].set_label(far);
            if (graph_.tags[end - 1].up())
                reach({static_cast<std::uint32_t>(c), column.last}, end - 1, 1, front_);
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
            const auto& column = graph_.columns[c];
            const auto own = Residual::node(column, entry);
            const auto tag = graph_.tags[own];
            if (entry - 1 > column.first && graph_.tags[own - 1].up())
                reach({c, lower(entry)}, own - 1, distance, next_);
            if (entry < column.last) reach({c, higher(entry)}, own + 1, distance, next_);
            for_each_side(c, [&](std::size_t other, unsigned d, int out) {
                const auto to = static_cast<std::uint32_t>(other);
                const auto& beside = graph_.columns[other];
                const auto go = [&](std::uint16_t at, std::uint32_t n) {
                    if (out < 0) reach({to, at}, n, distance, next_);
                    else sent_[static_cast<std::size_t>(out)].push_back({to, at});
                };
                if (const auto above = Residual::node(beside, entry + 1); above != none)
                    go(higher(entry), above);
                if (tag.lowered(d)) go(lower(entry), Residual::node(beside, entry - 1));
                if (graph_.level.empty()) return;
                if (const auto level = Residual::node(beside, entry);
                    level != none && graph_.level[level][Columns::back(d)] > 0)
                    go(spot.entry, level);
            });
        }
        std::swap(front_, next_);
        return !front_.empty();
    }
    /// Adds nodes that other regions reached.
    void take_reached(std::vector<Spot>& spots, Label distance) {
        for (const auto& spot : spots)
            reach(spot, Residual::node(graph_.columns[spot.column], spot.entry), distance, front_);
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
    static constexpr auto far = Residual::far, none = Residual::none;
    static constexpr auto endless = Residual::endless;
    // closing, leaving: bits of Residual::sides behind those of the directions. wrapped: where
    // step_ holds the steps across the closing.
    static constexpr unsigned closing = 6, leaving = 10, wrapped = 6;

    static std::uint16_t higher(int entry) { return static_cast<std::uint16_t>(entry + 1); }
    static std::uint16_t lower(int entry) { return static_cast<std::uint16_t>(entry - 1); }

    template <class Call>
    void for_each_column(const Call& call) {
        for (auto t = box_.begin[2]; t < box_.end[2]; ++t)
            for (auto k = box_.begin[1]; k < box_.end[1]; ++k) {
                const auto first = graph_.layout.at(0, k, t);
                for (auto lateral = box_.begin[0]; lateral < box_.end[0]; ++lateral)
                    call(first + lateral, std::array{lateral, k, t});
            }
    }
    /// @param call  called with the neighbour, the direction to it, and -1 if it is inside, 0 if it
    ///   belongs to the region before, 1 if to the one behind
    template <class Call>
    void for_each_side(std::uint32_t c, const Call& call) {
        const unsigned sides = graph_.sides[c];
        for (unsigned rest = sides & 63; rest != 0; rest &= rest - 1) {
            const auto d = static_cast<unsigned>(std::countr_zero(rest));
            const bool across = d < 4 && (sides >> (closing + d) & 1),
                       leaves = d / 2 == along_ && (sides >> (leaving + d % 2) & 1);
            call(static_cast<std::size_t>(static_cast<std::ptrdiff_t>(c) +
                                          step_[across ? d + wrapped : d]),
                 d, leaves ? static_cast<int>(d % 2) : -1);
        }
    }

    void reach(const Spot& spot, std::uint32_t n, Label distance, std::vector<Spot>& out) {
        auto& tag = graph_.tags[n];
        if (tag.label() != far) return;
        tag.set_label(distance);
        out.push_back(spot);
        if (!tag.excess()) return;
        left_ += graph_.arcs[n].excess;
        active_.push_back(spot);
    }

    /// A node while its excess is pushed on.
    struct Excess {
        std::uint32_t column;
        std::uint16_t entry;
        std::uint32_t node;
        std::int64_t amount;
        Label label;
        Label nearest;  ///< the least distance among nodes at the ends of arcs with capacity left
    };

    /// A neighbouring column: its number, the direction to it, and to which region it belongs, as
    /// in for_each_side().
    struct Side {
        std::uint32_t column;
        unsigned direction;
        int out;
    };

    /// Pushes a node's excess on to nodes nearer to the sink, and raises the node's distance if
    /// some is left.
    /// @return number of visits of the node
    [[gnu::flatten]] int discharge(const Spot& spot) {
        const auto own = Residual::node(graph_.columns[spot.column], spot.entry);
        auto& tag = graph_.tags[own];
        auto& arcs = graph_.arcs[own];
        Excess from{spot.column, spot.entry, own, arcs.excess, tag.label(), far};
        if (from.amount == 0 || from.label == far) return 1;
        for (int steps = 1;; ++steps) {
            from.nearest = far;
            push_up(from);
            if (from.amount > 0)
                for_each_side(from.column, [&](std::size_t other, unsigned d, int out) {
                    const Side to{static_cast<std::uint32_t>(other), d, out};
                    if (from.amount == 0) return;
                    push_above(from, to);
                    push_level(from, to);
                    push_below(from, to);
                });
            if (from.amount > 0) push_down(from);
            if (from.amount > 0) from.label = from.nearest == far ? far : from.nearest + 1;
            if (from.amount > 0 && from.label != far) continue;
            tag.set_label(from.label);
            tag.set_up(arcs.up > 0);
            tag.set_excess(from.amount > 0);
            arcs.excess = from.amount;
            return steps;
        }
    }

    void give(Excess& from, std::uint32_t n, const Spot& spot, int out, std::int64_t amount) {
        auto& tag = graph_.tags[n];
        if (!tag.excess()) (out < 0 ? next_ : sent_[static_cast<std::size_t>(out)]).push_back(spot);
        tag.set_excess(true);
        graph_.arcs[n].excess += amount;
        from.amount -= amount;
    }

    /// To the next entry of the column, or from its last one to the sink.
    void push_up(Excess& from) {
        auto& up = graph_.arcs[from.node].up;
        if (up <= 0) return;
        const bool last = from.entry == graph_.columns[from.column].last;
        const Label above = last ? 0 : graph_.tags[from.node + 1].label();
        if (above + 1 == from.label) {
            const auto amount =
                up == endless ? from.amount : std::min<std::int64_t>(from.amount, up);
            if (up != endless) up -= static_cast<std::int32_t>(amount);
            if (last) {
                sunk_ += amount;
                from.amount -= amount;
            } else {
                give(from, from.node + 1, {from.column, higher(from.entry)}, -1, amount);
            }
        }
        if (up > 0) from.nearest = above;
    }

    /// To the entry before in the column.
    void push_down(Excess& from) {
        if (from.entry - 1 <= graph_.columns[from.column].first) return;
        const auto at = graph_.tags[from.node - 1].label();
        if (at + 1 == from.label) {
            auto& up = graph_.arcs[from.node - 1].up;
            const auto amount =
                up == endless ? from.amount : std::min<std::int64_t>(from.amount, endless - 1 - up);
            overflowed_ = overflowed_ || amount < from.amount;
            if (up != endless) up += static_cast<std::int32_t>(amount);
            graph_.tags[from.node - 1].set_up(true);
            give(from, from.node - 1, {from.column, lower(from.entry)}, -1, amount);
        }
        from.nearest = std::min(from.nearest, at);
    }

    /// To the entry above in a neighbouring column.
    void push_above(Excess& from, const Side& to) {
        const auto above = Residual::node(graph_.columns[to.column], from.entry + 1);
        const auto back = Columns::back(to.direction);
        // The tag tells whether capacity is left. The amount is far away in memory, so it is read
        // only to push.
        if (above == none || !graph_.tags[above].lowered(back)) return;
        const auto at = graph_.tags[above].label();
        bool stays = true;
        if (at + 1 == from.label) {
            auto& lowered = graph_.arcs[above].lowered[back];
            const auto amount = std::min<std::int64_t>(from.amount, lowered);
            lowered -= static_cast<std::int32_t>(amount);
            stays = lowered > 0;
            if (!stays) graph_.tags[above].set_lowered(back, false);
            give(from, above, {to.column, higher(from.entry)}, to.out, amount);
        }
        if (stays) from.nearest = std::min(from.nearest, at);
    }

    /// To the same entry in a neighbouring column.
    void push_level(Excess& from, const Side& to) {
        const auto level =
            graph_.level.empty() ? none : Residual::node(graph_.columns[to.column], from.entry);
        if (level == none || graph_.level[from.node][to.direction] <= 0) return;
        const auto at = graph_.tags[level].label();
        auto& through = graph_.level[from.node][to.direction];
        if (at + 1 == from.label && from.amount > 0) {
            const auto amount = std::min<std::int64_t>(from.amount, through);
            through -= static_cast<std::int32_t>(amount);
            graph_.level[level][Columns::back(to.direction)] += static_cast<std::int32_t>(amount);
            give(from, level, {to.column, from.entry}, to.out, amount);
        }
        if (through > 0) from.nearest = std::min(from.nearest, at);
    }

    /// To the entry below in a neighbouring column.
    void push_below(Excess& from, const Side& to) {
        const auto below = Residual::node(graph_.columns[to.column], from.entry - 1);
        if (below == none) return;
        const auto at = graph_.tags[below].label();
        auto& lowered = graph_.arcs[from.node].lowered[to.direction];
        if (at + 1 == from.label && from.amount > 0) {
            const auto amount = std::min<std::int64_t>(from.amount, endless - lowered);
            overflowed_ = overflowed_ || amount < from.amount;
            lowered += static_cast<std::int32_t>(amount);
            graph_.tags[from.node].set_lowered(to.direction, true);
            give(from, below, {to.column, lower(from.entry)}, to.out, amount);
        }
        if (lowered < endless) from.nearest = std::min(from.nearest, at);
    }

    Residual& graph_;
    const ColumnBox box_;
    std::array<std::ptrdiff_t, 12> step_;
    unsigned along_ = 0;  ///< the dimension in which the columns before and behind the box belong
                          ///< to other regions
    std::size_t size_ = 0;
    std::int64_t sunk_ = 0, left_ = 0;
    bool overflowed_ = false;
    std::vector<Spot> front_, next_, active_;
    std::array<std::vector<Spot>, 2> sent_;
};

}  // namespace fluidcarve
