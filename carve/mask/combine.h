#pragma once

#include "carve/base/values.h"
#include "carve/volume/volume.h"

#include <array>
#include <utility>
#include <vector>

namespace fluidcarve {

/// How masks are combined.
enum class MaskMode {
    any,    ///< union: voxels in any of the masks
    all,    ///< intersection: voxels in all masks
    first,  ///< difference: voxels in the first mask and in no other
};

template <>
struct ChoiceNames<MaskMode> {
    static constexpr std::array names = {std::pair{"union", MaskMode::any},
                                         std::pair{"intersection", MaskMode::all},
                                         std::pair{"difference", MaskMode::first}};
};

/// Combines masks to one.
/// @param masks  at least one, all with the same transform
/// @throws Failure naming two masks with different transforms
MaskGrid::Ptr combined_mask(const std::vector<Ref<MaskGrid>>& masks, MaskMode mode);

}  // namespace fluidcarve
