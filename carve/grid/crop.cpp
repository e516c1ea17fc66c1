#include "carve/grid/crop.h"

#include "carve/grid/each_grid.h"

namespace fluidcarve {

Volume cropped(const Volume& volume, const openvdb::BBoxd& box) {
    return each_grid(volume, [&](const auto& grid) -> openvdb::GridBase::ConstPtr {
        const auto out = grid->deepCopy();
        out->clipGrid(box);
        return out;
    });
}

}  // namespace fluidcarve
