#pragma once

#include "graph/param.h"

namespace fluidcarve {

class NodeCheck;

/// The parameter `rim` of nodes that carve: displacements end with a jump at the lattice's rims, or go to 0 (CarveMap::fade).
enum class Rim { cut, fade };

template <>
struct ChoiceNames<Rim> {
    static constexpr std::array names = {std::pair{"cut", Rim::cut}, std::pair{"fade", Rim::fade}};
};

inline constexpr auto fade_doc = "For `rim: fade`: from how far on displacements fade. What is further inside is carved as with `rim: cut`.";

/// Finds fault with a `fade` that nothing uses.
void check_fade(Rim rim, NodeCheck& check);

}  // namespace fluidcarve
