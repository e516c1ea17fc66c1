#include "nodes/mask/weight.h"

#include "nodes/field/same_transform.h"

namespace fluidcarve {

FloatGrid::Ptr weighted_energy(const FloatGrid& energy, const std::vector<WeightedRegion>& regions, float outside, WeightMode mode) {
    using Tree = openvdb::FloatTree;
    const auto weigh = [mode](float weight, float value) { return mode == WeightMode::assign ? weight * (1 + value) / 2 : weight * value; };
    // After the unions, a tile of the result is a tile in all grids: one voxel of it stands for all.
    const auto tree = std::make_shared<Tree>(energy.tree(), weigh(outside, energy.background()), openvdb::TopologyCopy());
    for (std::size_t n = 0; n < regions.size(); ++n) {
        require_same_transform(fmt::format("the energy and mask {}", n + 1), energy, *regions[n].mask);
        tree->topologyUnion(regions[n].mask->tree());
    }

    class Look {
    public:
        Look(const FloatGrid& energy, const std::vector<WeightedRegion>& regions) : energy_(energy.getConstAccessor()), regions_(regions) {
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
    openvdb::tree::LeafManager<Tree>(*tree).foreach ([&](Tree::LeafNodeType& leaf, std::size_t) {
        Look look(energy, regions);
        for (auto voxel = leaf.beginValueOn(); voxel; ++voxel) voxel.setValue(weigh(look.weight(voxel.getCoord(), outside), look.energy(voxel.getCoord())));
    });
    Look look(energy, regions);
    auto tile = tree->beginValueOn();
    tile.setMaxDepth(Tree::ValueOnIter::LEAF_DEPTH - 1);
    for (; tile; ++tile) tile.setValue(weigh(look.weight(tile.getCoord(), outside), look.energy(tile.getCoord())));

    auto out = FloatGrid::create(tree);
    out->setTransform(energy.transform().copy());
    return out;
}

template <>
struct ChoiceNames<WeightMode> {
    static constexpr std::array names = {std::pair{"assign", WeightMode::assign}, std::pair{"multiply", WeightMode::multiply}};
};

namespace {

struct Weight {
    struct Params {
        std::vector<float> weights;
        float outside = 1;
        WeightMode mode = WeightMode::assign;
    };
    struct Ports {
        Ref<FloatGrid> energy;
        List<MaskGrid> masks;
        Ref<FloatGrid> weighted;
    };
    static void check(const Params& params, NodeCheck& check) {
        if (const auto masks = check.connections("masks"); masks > 0 && params.weights.size() != masks)
            check.fault("weights", fmt::format("parameter 'weights' has {} numbers for {} masks; state one for each", params.weights.size(), masks));
    }
    static void run(const Params& params, Ports& io, Context&) {
        std::vector<WeightedRegion> regions;
        for (std::size_t n = 0; n < io.masks.size(); ++n) regions.push_back({io.masks[n], params.weights[n]});
        io.weighted = weighted_energy(*io.energy, regions, params.outside, params.mode);
    }
};

}  // namespace

NodeType mask_weight() {
    return Declare<Weight>("mask.weight", "Weights an energy by regions: high weights keep seams away, also from empty space; low weights attract them.")
        .input("energy", &Weight::Ports::energy, "An energy from 0 to 1, such as that of energy.combine with weights that add up to 1.")
        .input("masks", &Weight::Ports::masks, "The regions. Where they overlap, the later one counts.")
        .required("weights", &Weight::Params::weights, Unit::none, at_least(0), "One weight per mask.")
        .param("outside", &Weight::Params::outside, Unit::none, at_least(0), "The weight outside of all masks.")
        .param("mode", &Weight::Params::mode, "assign: weight * (1 + energy) / 2, so that mainly the region decides. multiply: weight * energy.")
        .output("energy", &Weight::Ports::weighted, "The weighted energy.")
        .in_place();
}

}  // namespace fluidcarve
