#pragma once

#include "carve/solver/search/band.h"
#include "carve/solver/search/columns.h"
#include "carve/solver/search/strip.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

/// Finds seams that pass no protected vertex, of infinite cost (METHOD 8 "Protection"). Protection
/// leaves holes, not intervals. But if two seams pass no protected vertex, neither does the seam of
/// their lower entries, nor that of their upper entries. So, if there is such a seam at or above
/// given entries, there is a lowest one. Raising an entry only if it is protected, or more than 1
/// below a neighbour, leads to it. Costs are functions of (column, entry).
namespace fluidcarve {

namespace detail {

/// Moves entries in the direction `step`, 1 or -1, as little as possible, to a seam.
/// @return as raise_to_seam()
template <int step, class CostAt>
std::optional<std::size_t> move_to_seam(const Columns& columns, std::vector<std::uint16_t>& at,
                                        const Band& band, const CostAt& cost_at) {
    const auto take_free = [&](std::size_t c, int entry) {
        const int last = step > 0 ? band.columns[c].last : band.columns[c].first;
        while (step * entry <= step * last && std::isinf(cost_at(c, entry))) entry += step;
        at[c] = static_cast<std::uint16_t>(entry);
        return step * entry <= step * last;
    };
    std::vector<std::size_t> moved(at.size()), next;
    for (std::size_t c = 0; c < at.size(); ++c) {
        if (!take_free(c, at[c])) return c;
        moved[c] = c;
    }
    while (!moved.empty()) {
        next.clear();
        for (const auto c : moved)
            for (const auto other : columns.neighbours(c, columns.place(c))) {
                if (other == Columns::none || step * (at[c] - at[other]) <= 1) continue;
                if (!take_free(other, at[c] - step)) return other;
                next.push_back(other);
            }
        std::swap(moved, next);
    }
    return std::nullopt;
}

}  // namespace detail

/// Raises entries to the lowest seam at or above them.
/// @param at  inside the band
/// @return nothing; or, if the band holds no such seam, the column whose entries ran out first
template <class CostAt>
std::optional<std::size_t> raise_to_seam(const Columns& columns, std::vector<std::uint16_t>& at,
                                         const Band& band, const CostAt& cost_at) {
    return detail::move_to_seam<1>(columns, at, band, cost_at);
}

/// Lowers entries to the highest seam at or below them.
template <class CostAt>
std::optional<std::size_t> lower_to_seam(const Columns& columns, std::vector<std::uint16_t>& at,
                                         const Band& band, const CostAt& cost_at) {
    return detail::move_to_seam<-1>(columns, at, band, cost_at);
}

/// Finds the lowest seam of a band.
/// @param at  becomes the seam
/// @return as raise_to_seam()
template <class CostAt>
std::optional<std::size_t> lowest_seam(const Columns& columns, std::vector<std::uint16_t>& at,
                                       const Band& band, const CostAt& cost_at) {
    at.clear();
    for (const auto& column : band.columns) at.push_back(column.first);
    return raise_to_seam(columns, at, band, cost_at);
}

/// The part of a band between its lowest seam and its highest. Both ends of every column are then
/// free.
/// @param band  holds at least one seam
template <class CostAt>
Band tightened(const Columns& columns, const Band& band, const CostAt& cost_at) {
    std::vector<std::uint16_t> low, high;
    lowest_seam(columns, low, band, cost_at);
    for (const auto& column : band.columns) high.push_back(column.last);
    lower_to_seam(columns, high, band, cost_at);
    Band out;
    for (std::size_t c = 0; c < low.size(); ++c) out.columns.push_back({low[c], high[c]});
    return out;
}

/// Moves a seam aside where it passes protected vertices: to the highest seam below it or to the
/// lowest above it, whichever is cheaper. Columns that are protected throughout on one side move
/// to the other side.
/// @param seam  in the band, feasible except at protected vertices
/// @param band  holds at least one seam
template <class CostAt>
std::vector<std::uint16_t> moved_aside(const Columns& columns,
                                       const std::vector<std::uint16_t>& seam, const Band& band,
                                       const CostAt& cost_at, const StepCosts& steps) {
    const auto tight = tightened(columns, band, cost_at);
    auto below = seam, above = seam;
    for (std::size_t c = 0; c < seam.size(); ++c) {
        below[c] = std::max(seam[c], tight.columns[c].first);
        above[c] = std::min(seam[c], tight.columns[c].last);
    }
    lower_to_seam(columns, below, tight, cost_at);
    raise_to_seam(columns, above, tight, cost_at);
    const auto cost = [&](const std::vector<std::uint16_t>& at) {
        double out = cost_of_steps(columns, steps, at);
        for (std::size_t c = 0; c < at.size(); ++c) out += static_cast<double>(cost_at(c, at[c]));
        return out;
    };
    return cost(below) <= cost(above) ? below : above;
}

/// The same in a window. Returns the seam itself if it passes no protected vertices.
std::vector<std::uint16_t> past_protected(const EnergyVolume& energy, Window window,
                                          std::vector<std::uint16_t> seam);

}  // namespace fluidcarve
