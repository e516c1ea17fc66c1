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

/// decode_field() of many codes, in the same way.
/// @param out  as many
inline void decode_fields(std::span<const std::uint16_t> codes, std::span<float> out) {
    for (std::size_t n = 0; n < codes.size(); ++n) {
        const std::uint32_t code = codes[n];
        const float size = std::bit_cast<float>((code & 0x7FFFu) << 13) * 0x1p112f;
        out[n] = std::bit_cast<float>(std::bit_cast<std::uint32_t>(size) | (code & 0x8000u) << 16);
    }
}

}  // namespace fluidcarve
