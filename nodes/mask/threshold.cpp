#include "nodes/mask/threshold.h"

#include "nodes/field/active_range.h"
#include "nodes/field/missed_range.h"

#include <openvdb/tools/Count.h>

#include <limits>
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
        if (!inside(field.tree().getValue(tile.getCoord()))) outside.emplace_back(tile.getLevel(), tile.getCoord());
    for (const auto& [level, at] : outside) tree->addTile(level, at, false, false);
    auto out = MaskGrid::create(tree);
    out->setTransform(field.transform().copy());
    return out;
}

namespace {

struct Threshold {
    struct Params {
        Auto<double> above, below;
    };
    struct Ports {
        Ref<FloatGrid> field;
        Ref<MaskGrid> mask;
    };
    static void check(const Params& params, NodeCheck& check) {
        if (!params.above && !params.below) check.fault("type", "needs 'above', 'below' or both");
        if (params.above && params.below && *params.above > *params.below)
            check.fault("above", fmt::format("parameter 'above', {:g}, is higher than 'below', {:g}: no value fits", *params.above, *params.below));
    }
    static void foresee(const Params&, Outlook& ahead) {
        const auto* const field = ahead.region("field");
        if (!field) return;
        if (field->boxes.empty()) ahead.warn("by their headers, the files that `field` comes from have no active voxels in any frame: the mask is empty");
        ahead.lies(*field);
    }
    static void run(const Params& params, Ports& io, Context&) {
        constexpr auto unbounded = std::numeric_limits<double>::infinity();
        const Interval wanted{params.above.value_or(-unbounded), params.below.value_or(unbounded)};
        const auto mask = threshold_mask(*io.field, wanted.low, wanted.high);
        if (mask->activeVoxelCount() == 0) {
            const auto values = openvdb::tools::minMax(io.field->tree());
            const bool none = io.field->activeVoxelCount() == 0;
            note_missed_range(*mask, {wanted, none ? empty_range : Interval{values.min(), values.max()}});
        }
        io.mask = mask;
    }
};

}  // namespace

NodeType mask_threshold() {
    return Declare<Threshold>("mask.threshold", "The voxels with a value in a range: where the smoke is, or where it is hot.")
        .input("field", &Threshold::Ports::field, "Density, temperature, flame or any other field. Only its active voxels can be in the mask.")
        .param("above", &Threshold::Params::above, Unit::none, any_number(), "Lowest value, in the field's unit. Auto: no bound.")
        .param("below", &Threshold::Params::below, Unit::none, any_number(), "Highest value, in the field's unit. Auto: no bound.")
        .output("mask", &Threshold::Ports::mask, "The voxels with a value in the range.")
        .kept()
        .in_place();
}

}  // namespace fluidcarve
