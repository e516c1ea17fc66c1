#include "carve/field/shown.h"

#include <openvdb/tools/Count.h>

namespace fluidcarve {

Shown::Shown(const FloatGrid& grid)
    : level_set_(grid.getGridClass() == openvdb::GRID_LEVEL_SET),
      edge_(level_set_ ? 0 : share * openvdb::tools::minMax(grid.constTree()).max()) {}

}  // namespace fluidcarve
