#include "carve/grid/crop.h"

#include "carve/field/extent.h"
#include "carve/grid/each_grid.h"

namespace fluidcarve {

Volume cropped(const Volume& volume, const openvdb::BBoxd& box) {
    return each_grid(volume, [&](const auto& grid) -> openvdb::GridBase::ConstPtr {
        const auto index = grid->transform().worldToIndex(box);
        const auto out = grid->deepCopy();
        out->clip(openvdb::CoordBBox(openvdb::Coord::floor(near_place(index.min())),
                                     openvdb::Coord::floor(near_place(index.max()))));
        return out;
    });
}

}  // namespace fluidcarve
