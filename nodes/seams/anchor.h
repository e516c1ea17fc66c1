#pragma once

namespace fluidcarve {

/// What stays where it is when a carve moves the rest along its axis.
struct Anchor {
    enum class At {
        low,     ///< the lattice's first vertex
        middle,  ///< its middle
        high,    ///< its last vertex
        vertex,  ///< the content of one vertex, to the nearest whole vertex: by its mean move over all columns and frames
    };
    At at = At::low;
    int vertex = 0;  ///< for At::vertex
    bool operator==(const Anchor&) const = default;
};

}  // namespace fluidcarve
