#include "carve/mask/threshold.h"

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace fluidcarve {

MaskGrid::Ptr threshold_mask(const FloatGrid& field, double low, double high) {
    using Tree = openvdb::MaskTree;
    const auto inside = [low, high](float value) { return value >= low && value <= high; };
    const auto tree = std::make_shared<Tree>(field.tree(), false, true, openvdb::TopologyCopy());
    openvdb::tree::LeafManager<Tree>(*tree).foreach ([&](Tree::LeafNodeType& leaf, std::size_t) {
        const auto* const values = field.tree().probeConstLeaf(leaf.origin());
        for (auto voxel = leaf.beginValueOn(); voxel; ++voxel)
            if (!inside(values->getValue(voxel.pos()))) leaf.setValueOff(voxel.pos());
    });
    std::vector<std::pair<openvdb::Index, openvdb::Coord>> outside;
    auto tile = tree->cbeginValueOn();
    tile.setMaxDepth(Tree::ValueOnCIter::LEAF_DEPTH - 1);
    for (; tile; ++tile)
        if (!inside(field.tree().getValue(tile.getCoord())))
            outside.emplace_back(tile.getLevel(), tile.getCoord());
    for (const auto& [level, at] : outside) tree->addTile(level, at, false, false);
    auto out = MaskGrid::create(tree);
    out->setTransform(field.transform().copy());
    return out;
}

}  // namespace fluidcarve
