#include "carve/volume/grid_instances.h"

namespace openvdb {
OPENVDB_USE_VERSION_NAMESPACE
namespace OPENVDB_VERSION_NAME {

#define FLUIDCARVE_INSTANCE(GridT)                            \
    template class tree::Tree<GridT::TreeType::RootNodeType>; \
    template class Grid<GridT::TreeType>;
FLUIDCARVE_EACH_GRID_TYPE(FLUIDCARVE_INSTANCE)
#undef FLUIDCARVE_INSTANCE

}  // namespace OPENVDB_VERSION_NAME
}  // namespace openvdb
