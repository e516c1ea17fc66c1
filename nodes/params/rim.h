#pragma once

#include "graph/types/param.h"

namespace fluidcarve {

class NodeCheck;

/// The parameter `rim` of nodes that carve: how displacements end at the lattice's rims. cut: with
/// a jump; fade: they go linearly to 0 (CarveMap::fade_rims).
enum class Rim { cut, fade };

template <>
struct ChoiceNames<Rim> {
    static constexpr std::array names = {std::pair{"cut", Rim::cut}, std::pair{"fade", Rim::fade}};
};

inline constexpr auto rim_fade_doc =
    "For `rim: fade`: the distance from the rim at which displacements begin to fade. Further "
    "inside, the carve is as with `rim: cut`.";

/// Reports a fault if `rim_fade` is stated, but `rim` does not use it.
void check_rim_fade(Rim rim, NodeCheck& check);

}  // namespace fluidcarve
