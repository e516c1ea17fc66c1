#pragma once

#include "carve/base/each_in_parallel.h"
#include "carve/seam/window.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace fluidcarve {

/// For each column of a sequence, the interval of entries in which a seam is searched. Intervals of
/// neighbouring columns differ by at most 1 at either end, so any entry can be part of a seam in
/// the band.
struct Band {
    struct Column {
        std::uint16_t first, last;
    };
    std::vector<Column> columns;  ///< in the order of Seams::Seam::at

    /// The whole window in every column.
    static Band whole(std::size_t columns, Window window) {
        return {std::vector<Column>(columns, {static_cast<std::uint16_t>(window.first),
                                              static_cast<std::uint16_t>(window.last)})};
    }
    /// The band around a seam.
    /// @param seam    feasible, inside the window
    /// @param radius  entries on either side of the seam; near an end of the window, the band
    ///   keeps its size and shifts to the other side
    static Band around(std::span<const std::uint16_t> seam, int radius, Window window) {
        Band out{std::vector<Column>(seam.size())};
        const int size = std::min(2 * radius + 1, window.size());
        each_in_parallel(seam.size(), 1 << 16, [&](std::size_t c) {
            const int first = std::clamp(seam[c] - radius, window.first, window.last + 1 - size);
            out.columns[c] = {static_cast<std::uint16_t>(first),
                              static_cast<std::uint16_t>(first + size - 1)};
        });
        return out;
    }
};

}  // namespace fluidcarve
