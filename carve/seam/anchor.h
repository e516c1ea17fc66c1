#pragma once

namespace fluidcarve {

/// The part of the carved axis that stays in place while a carve moves the rest.
struct Anchor {
    enum class At {
        low,     ///< the lattice's first vertex
        middle,  ///< the lattice's middle
        high,    ///< the lattice's last vertex
        vertex,  ///< the content of one vertex: by its mean displacement over all columns and
                 ///< frames, rounded to whole vertices
    };
    At at = At::low;
    int vertex = 0;  ///< index along the carved axis, for At::vertex
    bool operator==(const Anchor&) const = default;
};

}  // namespace fluidcarve
