#pragma once

#include "carve/simd/wide.h"

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace fluidcarve {

/// Eight values at once.
using Eight = float __attribute__((vector_size(32)));
using EightPlaces = std::int32_t __attribute__((vector_size(32)));

/// The next multiple of eight.
constexpr std::size_t whole_eights(std::size_t values) { return (values + 7) / 8 * 8; }

/// Stands for an infinite cost; sums and differences of it stay finite.
constexpr float endless_cost = 1e30f;
constexpr EightPlaces eight_places{0, 1, 2, 3, 4, 5, 6, 7};

// These functions are always inlined, so the way a call would pass vectors does not matter.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"
/// Eight consecutive values.
FLUIDCARVE_INLINE Eight eight_at(const float* values) {
    Eight out;
    std::memcpy(&out, values, sizeof out);
    return out;
}
FLUIDCARVE_INLINE Eight eight_of(float value) { return Eight{} + value; }
FLUIDCARVE_INLINE Eight least(Eight a, Eight b) { return a < b ? a : b; }
FLUIDCARVE_INLINE Eight absolute(Eight values) { return values < 0 ? -values : values; }
#pragma GCC diagnostic pop

}  // namespace fluidcarve
