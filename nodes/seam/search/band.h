#pragma once

#include "nodes/seams/window.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace fluidcarve {

/// For each column of a sequence the entries among which a seam is looked for. Intervals of neighbours differ by at most 1
/// at either end, so that any entry can be part of a seam in the band.
struct Band {
    struct Column {
        std::uint16_t first, last;
    };
    std::vector<Column> columns;  ///< in the order of Seams::Seam::at

    static Band whole(std::size_t columns, Window window) {
        return {std::vector<Column>(columns, {static_cast<std::uint16_t>(window.first), static_cast<std::uint16_t>(window.last)})};
    }
    /// @param seam    feasible, inside the window
    /// @param radius  entries to either side of the seam; at a window's end as many, but all to one side
    static Band around(std::span<const std::uint16_t> seam, int radius, Window window) {
        Band out;
        out.columns.reserve(seam.size());
        const int size = std::min(2 * radius + 1, window.size());
        for (const int entry : seam) {
            const int first = std::clamp(entry - radius, window.first, window.last + 1 - size);
            out.columns.push_back({static_cast<std::uint16_t>(first), static_cast<std::uint16_t>(first + size - 1)});
        }
        return out;
    }
};

}  // namespace fluidcarve
