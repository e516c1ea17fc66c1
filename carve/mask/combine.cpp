#include "carve/mask/combine.h"

#include "carve/base/values.h"
#include "carve/field/same_transform.h"

#include <fmt/format.h>
#include <openvdb/tools/Prune.h>

#include <cstddef>

namespace fluidcarve {

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
    out->setName(choice_text(mode) + " of masks");
    return out;
}

}  // namespace fluidcarve
