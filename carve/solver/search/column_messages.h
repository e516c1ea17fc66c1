#pragma once

#include "carve/vectors/eight.h"

namespace fluidcarve {

/// Messages between a column and the next one along each dimension. After a pass forward they are
/// from the column, after a pass back to it.
struct alignas(32) ColumnMessages {
    /// Entries of a column in the widest strip.
    static constexpr int most_entries = 7;

    Eight along[3];  ///< a value of each entry, and at least one that says nothing
};

}  // namespace fluidcarve
