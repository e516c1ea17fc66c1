#include "carve/field/shown_part.h"

#include <openvdb/tools/Count.h>

namespace fluidcarve {

ShownPart::ShownPart(const FloatGrid& grid)
    : level_set_(grid.getGridClass() == openvdb::GRID_LEVEL_SET),
      edge_(level_set_ ? 0 : share * openvdb::tools::minMax(grid.constTree()).max()) {}

}  // namespace fluidcarve
