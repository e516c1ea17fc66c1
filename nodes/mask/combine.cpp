#include "nodes/mask/combine.h"

#include "nodes/field/same_transform.h"

#include <openvdb/tools/Prune.h>

namespace fluidcarve {

template <>
struct ChoiceNames<MaskMode> {
    static constexpr std::array names = {std::pair{"union", MaskMode::any}, std::pair{"intersection", MaskMode::all}, std::pair{"difference", MaskMode::first}};
};

namespace {

struct MaskCombine {
    struct Params {
        MaskMode mode = MaskMode::any;
    };
    struct Ports {
        List<MaskGrid> masks;
        Ref<MaskGrid> mask;
    };
    static void run(const Params& params, Ports& io, Context&) { io.mask = combined_mask(io.masks, params.mode); }
};

}  // namespace

MaskGrid::Ptr combined_mask(const std::vector<Ref<MaskGrid>>& masks, MaskMode mode) {
    const auto out = masks.at(0)->deepCopy();
    for (std::size_t n = 1; n < masks.size(); ++n) {
        require_same_transform(fmt::format("masks 1 and {}", n + 1), *masks[0], *masks[n]);
        const auto& other = masks[n]->tree();
        switch (mode) {
            case MaskMode::any: out->tree().topologyUnion(other, true); break;
            case MaskMode::all: out->tree().topologyIntersection(other); break;
            case MaskMode::first: out->tree().topologyDifference(other); break;
        }
    }
    openvdb::tools::pruneInactive(out->tree());
    out->setName(ParamTraits<MaskMode>::text(mode) + " of masks");
    return out;
}

NodeType mask_combine() {
    return Declare<MaskCombine>("mask.combine", "Combines masks to one: the voxels in any of them, in all, or only in the first.")
        .input("masks", &MaskCombine::Ports::masks, "Masks with the same transform.")
        .param("mode", &MaskCombine::Params::mode,
               "union: voxels in any of the masks. intersection: voxels in all. difference: voxels in the first and in no other.")
        .output("mask", &MaskCombine::Ports::mask, "The combined mask.")
        .kept()
        .in_place();
}

}  // namespace fluidcarve
