#pragma once

#include <cstddef>
#include <vector>

namespace fluidcarve {

/// Places boxes in columns from left to right, every edge pointing right (Sugiyama et al. 1981: layers by longest path,
/// order within a layer by barycentres, then heights by least squares). Lengths in pixels, y down.
struct Layout {
    struct Box {
        double width = 0;   ///< in: least; out: that of its column
        double height = 0;  ///< in
        double x = 0;       ///< out: left
        double y = 0;       ///< out: top
    };
    struct Point {
        double x = 0;
        double y = 0;
    };
    struct Edge {
        std::size_t from = 0;  ///< index of a box, less than `to`
        std::size_t to = 0;
        std::vector<Point> route;  ///< out: from right to left border; pairs of points, each pair to be joined by a curve level at both ends
    };

    std::vector<Box> boxes;
    std::vector<Edge> edges;
    double width = 0;   ///< out
    double height = 0;  ///< out

    void place();
};

}  // namespace fluidcarve
