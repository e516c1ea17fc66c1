#include "carve/mask/weight.h"

#include "carve/field/same_transform.h"

#include <fmt/format.h>

#include <cstddef>
#include <memory>

namespace fluidcarve {

namespace {

/// Looks up energies and weights.
class Look {
public:
    Look(const FloatGrid& energy, const std::vector<WeightedRegion>& regions)
        : energy_(energy.getConstAccessor()), regions_(regions) {
        for (const auto& region : regions) masks_.push_back(region.mask->getConstAccessor());
    }
    float energy(const openvdb::Coord& at) { return energy_.getValue(at); }
    float weight(const openvdb::Coord& at, float outside) {
        for (auto n = masks_.size(); n-- > 0;)
            if (masks_[n].isValueOn(at)) return regions_[n].weight;
        return outside;
    }

private:
    FloatGrid::ConstAccessor energy_;
    const std::vector<WeightedRegion>& regions_;
    std::vector<MaskGrid::ConstAccessor> masks_;
};

}  // namespace

FloatGrid::Ptr weighted_energy(const FloatGrid& energy, const std::vector<WeightedRegion>& regions,
                               float outside, WeightMode mode) {
    using Tree = openvdb::FloatTree;
    const auto weigh = [mode](float weight, float value) {
        return mode == WeightMode::assign ? weight * (1 + value) / 2 : weight * value;
    };
    // After the unions, a tile of the result is a tile in all grids: one voxel of it stands for
    // all.
    const auto tree = std::make_shared<Tree>(energy.tree(), weigh(outside, energy.background()),
                                             openvdb::TopologyCopy());
    for (std::size_t n = 0; n < regions.size(); ++n) {
        require_same_transform(fmt::format("the energy and mask {}", n + 1), energy,
                               *regions[n].mask);
        tree->topologyUnion(regions[n].mask->tree());
    }

    openvdb::tree::LeafManager<Tree>(*tree).foreach ([&](Tree::LeafNodeType& leaf, std::size_t) {
        Look look(energy, regions);
        for (auto voxel = leaf.beginValueOn(); voxel; ++voxel)
            voxel.setValue(
                weigh(look.weight(voxel.getCoord(), outside), look.energy(voxel.getCoord())));
    });
    Look look(energy, regions);
    auto tile = tree->beginValueOn();
    tile.setMaxDepth(Tree::ValueOnIter::LEAF_DEPTH - 1);
    for (; tile; ++tile)
        tile.setValue(weigh(look.weight(tile.getCoord(), outside), look.energy(tile.getCoord())));

    auto out = FloatGrid::create(tree);
    out->setTransform(energy.transform().copy());
    return out;
}

}  // namespace fluidcarve
