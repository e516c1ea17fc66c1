#pragma once

#include <cstddef>
#include <vector>

namespace fluidcarve {

/// A layered graph layout (Sugiyama et al. 1981): boxes stand in columns and every edge points
/// right. Columns by longest path, order within a column by barycentres, heights by least squares.
/// Lengths in pixels, y points down.
struct Layout {
    struct Box {
        double width = 0;   ///< in: minimum width; out: width of its column
        double height = 0;  ///< in
        double x = 0;       ///< out: left border
        double y = 0;       ///< out: upper border
    };
    struct Point {
        double x = 0;
        double y = 0;
    };
    struct Edge {
        std::size_t from = 0;  ///< index of a box; must be less than `to`
        std::size_t to = 0;
        /// Out: points from the right border of `from` to the left border of `to`, in pairs. A pair
        /// is joined by a curve that is horizontal at both ends, neighbouring pairs by a straight
        /// line.
        std::vector<Point> route;
    };

    std::vector<Box> boxes;
    std::vector<Edge> edges;
    double width = 0;   ///< out
    double height = 0;  ///< out

    void place();
};

}  // namespace fluidcarve
