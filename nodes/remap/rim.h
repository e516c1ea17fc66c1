#pragma once

#include "graph/types/param.h"

namespace fluidcarve {

class NodeCheck;

/// The parameter `rim` of nodes that carve: displacements end with a jump at the lattice's rims, or go to 0 (CarveMap::fade).
enum class Rim { cut, fade };

template <>
struct ChoiceNames<Rim> {
    static constexpr std::array names = {std::pair{"cut", Rim::cut}, std::pair{"fade", Rim::fade}};
};

inline constexpr auto fade_doc = "For `rim: fade`: from how far on displacements fade. What is further inside is carved as with `rim: cut`.";

/// The parameters `soft` and `soft_time` (Softness).
inline constexpr double default_soft = 3, default_soft_time = 0;
inline constexpr auto soft_doc =
    "How softly seams are carved: each squeezes or draws out the space within about so many vertices along u, v and w, in place of cutting one vertex out or "
    "adding one. So nothing is lost, and no step is left. Whatever lies further from all seams is moved by whole vertices. 0: vertices are taken and added "
    "whole, "
    "as in classical seam carving.";
inline constexpr auto soft_time_doc = "The same from frame to frame: how many frames before and after take part in how far each vertex moves.";

/// Finds fault with a `fade` that nothing uses.
void check_fade(Rim rim, NodeCheck& check);

}  // namespace fluidcarve
