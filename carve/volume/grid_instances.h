#pragma once

#include "carve/volume/grid_types.h"

// The grid types of the nodes are instantiated once, in grid_instances.cpp. Otherwise each file
// that uses one compiles all its virtual functions again, which takes longer than the rest of the
// file.

namespace openvdb {
OPENVDB_USE_VERSION_NAMESPACE
namespace OPENVDB_VERSION_NAME {

#define FLUIDCARVE_DECLARE_INSTANCE(GridT)                           \
    extern template class tree::Tree<GridT::TreeType::RootNodeType>; \
    extern template class Grid<GridT::TreeType>;
FLUIDCARVE_EACH_GRID_TYPE(FLUIDCARVE_DECLARE_INSTANCE)
#undef FLUIDCARVE_DECLARE_INSTANCE

}  // namespace OPENVDB_VERSION_NAME
}  // namespace openvdb
