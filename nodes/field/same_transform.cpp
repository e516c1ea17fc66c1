#include "nodes/field/same_transform.h"

#include "graph/problem.h"

#include <fmt/format.h>

namespace fluidcarve {

void require_same_transform(const std::string& what, const openvdb::GridBase& first, const openvdb::GridBase& second) {
    if (first.transform() == second.transform()) return;
    const auto at = [](const openvdb::GridBase& grid) {
        const auto size = grid.voxelSize();
        const auto origin = grid.indexToWorld(openvdb::Vec3d(0));
        return fmt::format("'{}' (voxels of {:.6g} x {:.6g} x {:.6g}, the first at [{:.6g}, {:.6g}, {:.6g}])", grid.getName(), size.x(), size.y(), size.z(),
                           origin.x(), origin.y(), origin.z());
    };
    throw Failure(fmt::format("{} have different transforms: {} and {}; resample one onto the other", what, at(first), at(second)));
}

}  // namespace fluidcarve
