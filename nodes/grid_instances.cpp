#include "nodes/grid_instances.h"

namespace openvdb {
OPENVDB_USE_VERSION_NAMESPACE
namespace OPENVDB_VERSION_NAME {

template class tree::Tree<BoolTree::RootNodeType>;
template class tree::Tree<DoubleTree::RootNodeType>;
template class tree::Tree<FloatTree::RootNodeType>;
template class tree::Tree<Int32Tree::RootNodeType>;
template class tree::Tree<Int64Tree::RootNodeType>;
template class tree::Tree<MaskTree::RootNodeType>;
template class tree::Tree<Vec3DTree::RootNodeType>;
template class tree::Tree<Vec3ITree::RootNodeType>;
template class tree::Tree<Vec3STree::RootNodeType>;
template class Grid<BoolTree>;
template class Grid<DoubleTree>;
template class Grid<FloatTree>;
template class Grid<Int32Tree>;
template class Grid<Int64Tree>;
template class Grid<MaskTree>;
template class Grid<Vec3DTree>;
template class Grid<Vec3ITree>;
template class Grid<Vec3STree>;

}  // namespace OPENVDB_VERSION_NAME
}  // namespace openvdb
