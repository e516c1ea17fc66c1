#pragma once

#include "carve/base/values.h"
#include "carve/volume/volume.h"

#include <optional>
#include <string>

namespace fluidcarve {

/// Why the mask of a threshold is empty: no active value of the field lies in the range that is
/// wanted.
struct MissedRange {
    Interval wanted;  ///< infinite at an end without a bound
    Interval values;  ///< the field's; low > high: it has no active voxels
};

/// Notes in an empty mask why it is so. It travels with the mask, as metadata.
void note_missed_range(MaskGrid& mask, const MissedRange& missed);
/// What is noted in a mask; nothing: nothing.
std::optional<MissedRange> missed_range(const openvdb::GridBase& mask);
/// For messages: "mask.threshold marks values from 2, but the field has 0 to 0.9 only".
std::string text_of(const MissedRange& missed);

}  // namespace fluidcarve
