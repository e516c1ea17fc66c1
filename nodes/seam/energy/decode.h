#pragma once

#include "nodes/seam/energy/code.h"

#include <bit>
#include <cstddef>
#include <span>

namespace fluidcarve {

/// decode_energy() of many codes, by vector instructions: a code has the bits of a float, but for the bias of its exponent.
/// @param codes  at most highest_energy_code
/// @param out    as many
inline void decode_energies(std::span<const std::uint16_t> codes, std::span<float> out) {
    for (std::size_t n = 0; n < codes.size(); ++n) out[n] = std::bit_cast<float>(std::uint32_t{codes[n]} << 13) * 0x1p95f;
}

}  // namespace fluidcarve
