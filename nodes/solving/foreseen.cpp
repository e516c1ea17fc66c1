#include "nodes/solving/placement.h"

#include <fmt/format.h>

#include <algorithm>

namespace fluidcarve {

std::string placement_fault(const Region& energy, const Region* lattice) {
    if (energy.boxes.empty())
        return "by their headers, the files that `energy` comes from have no active voxels in any "
               "frame: there is nothing to carve; choose another grid under "
               "`grids` of their reader, `fluidcarve inspect` lists them";
    if (!lattice || lattice->boxes.empty() || meet(energy.boxes, lattice->boxes)) return {};
    const auto better = std::ranges::find_if(
        lattice->otherwise,
        [&](const Region::Otherwise& other) { return meet(energy.boxes, other.boxes); });
    return fmt::format(
        "the lattice misses the data: it lies within {}, but the files that `energy` comes from "
        "have voxels, by their headers, only from {}; {}",
        text_of(around(lattice->boxes)), text_of(around(energy.boxes)),
        better != lattice->otherwise.end() ? fmt::format("with {} they meet", better->how)
                                           : "move the lattice (its rig, or `min` and `max`) or "
                                             "the data (`translate` and `scale` of its reader)");
}

}  // namespace fluidcarve
