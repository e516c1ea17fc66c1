#pragma once

#include "graph/types/node_type.h"
#include "nodes/payloads.h"
#include "nodes/points/points.h"

namespace fluidcarve {

struct KeptOut {
    Points points;
    std::size_t moved = 0;
    std::size_t stuck = 0;  ///< so deep inside that the band does not say which way is out; they stay
};

/// Moves points that lie inside a solid out to its surface, each the shortest way; all others stay bit for bit.
/// @param solid  a level set, world units, below 0 inside
KeptOut kept_out(const Points& points, const FloatGrid& solid);

/// `points.keep_out {source, solid}`.
NodeType points_keep_out();

}  // namespace fluidcarve
