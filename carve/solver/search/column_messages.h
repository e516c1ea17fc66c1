#pragma once

#include "carve/simd/eight.h"

namespace fluidcarve {

/// Messages between a column and the next one along each dimension. A forward pass sends them from
/// the column, a backward pass to it.
struct alignas(32) ColumnMessages {
    /// Entries of a column in the widest strip.
    static constexpr int most_entries = 7;

    Eight along[3];  ///< one value per entry, and at least one unused value
};

}  // namespace fluidcarve
