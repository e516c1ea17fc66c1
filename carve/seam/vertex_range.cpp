#include "carve/seam/vertex_range.h"

#include <fmt/format.h>

#include <cmath>

namespace fluidcarve {

Window VertexRange::of(int size) const {
    const auto vertex = [&](double stated) {
        return static_cast<int>(std::lround(percent ? stated / 100 * (size - 1) : stated));
    };
    return {vertex(first), vertex(last)};
}

std::optional<Window> VertexRange::vertices() const {
    return percent ? std::nullopt : std::optional(of(0));
}

std::string to_text(const VertexRange& range) {
    const auto* const unit = range.percent ? "%" : "";
    return fmt::format("[{}{}, {}{}]", range.first, unit, range.last, unit);
}

std::string to_text(const PairRanges& ranges) {
    const auto above = to_text(ranges.above);
    return ranges.below ? fmt::format("[{}, {}]", to_text(*ranges.below), above) : above;
}

std::optional<Window> vertices_of(const Auto<VertexRange>& range) {
    return range ? range->vertices() : std::nullopt;
}

std::optional<std::string> pair_fault(const Window& window, const VertexRange& window_stated,
                                      const Window& pair, const VertexRange& pair_stated,
                                      bool share) {
    const int shared = share ? 1 : 0;
    if (pair.first > window.last - shared) return std::nullopt;
    return fmt::format("pair_window {} {} window {}; it must begin {}", to_text(pair_stated),
                       pair.last < window.first + shared ? "lies below" : "overlaps",
                       to_text(window_stated),
                       share ? fmt::format("at vertex {} or above", window.last)
                             : fmt::format("above vertex {}", window.last));
}

std::optional<std::string> pair_below_fault(const Window& window, const VertexRange& window_stated,
                                            const Window& pair, const VertexRange& pair_stated) {
    if (pair.last <= window.first) return std::nullopt;
    return fmt::format(
        "pair_window {}, the first of two, {} window {}; it must end at vertex {} or below",
        to_text(pair_stated), pair.first >= window.last ? "lies above" : "overlaps",
        to_text(window_stated), window.first);
}

}  // namespace fluidcarve
