#pragma once

#include "carve/base/values.h"
#include "carve/volume/volume.h"

#include <optional>
#include <string>

namespace fluidcarve {

/// Why a threshold's mask is empty: no active value of the field lies in the wanted range.
struct MissedRange {
    Interval wanted;  ///< infinite where no bound is set
    Interval values;  ///< the field's; low > high: it has no active voxels
};

/// Stores in an empty mask, as metadata, why it is empty.
void note_missed_range(MaskGrid& mask, const MissedRange& missed);
/// The reason stored by note_missed_range(), if any.
std::optional<MissedRange> missed_range(const openvdb::GridBase& mask);
/// For messages: "mask.threshold marks values from 2, but the field has 0 to 0.9 only".
std::string to_text(const MissedRange& missed);

}  // namespace fluidcarve
