#include "nodes/payloads.h"

#include <algorithm>

namespace fluidcarve {

openvdb::GridBase::ConstPtr Volume::find(const std::string& name) const {
    const auto found = std::find_if(grids.begin(), grids.end(), [&](const auto& grid) { return grid->getName() == name; });
    return found == grids.end() ? nullptr : *found;
}

std::string Volume::names() const {
    std::string out;
    for (const auto& grid : grids) out += (out.empty() ? "" : ", ") + grid->getName();
    return out;
}

}  // namespace fluidcarve
