#pragma once

#include "graph/types/param.h"

namespace fluidcarve {

class NodeCheck;

/// The parameter `rim` of nodes that carve: how displacements end at the lattice's rims. cut: with a jump; fade: they go linearly to 0
/// (CarveMap::fade).
enum class Rim { cut, fade };

template <>
struct ChoiceNames<Rim> {
    static constexpr std::array names = {std::pair{"cut", Rim::cut}, std::pair{"fade", Rim::fade}};
};

inline constexpr auto fade_doc =
    "For `rim: fade`: the distance from the rim at which displacements begin to fade. Further inside, the carve is as with `rim: cut`.";

/// Defaults of the parameters `soft` (vertices) and `soft_time` (frames); see Softness.
inline constexpr double default_soft = 3, default_soft_time = 0;
inline constexpr auto soft_doc =
    "How softly seams are carved. Each seam squeezes or stretches the space within about this distance along u, v and w, instead of cutting one vertex out or "
    "adding one. So nothing is lost, and no step remains. Everything further from all seams moves by whole vertices. 0: vertices are taken and added whole, as "
    "in classical seam carving. A warp is smooth by itself, and stays as it is.";
inline constexpr auto soft_time_doc = "The same in time: the number of frames before and after that influence how far each vertex moves.";

/// Reports a fault if `fade` is stated, but `rim` does not use it.
void check_fade(Rim rim, NodeCheck& check);

}  // namespace fluidcarve
