#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace fluidcarve {

/// Energies in 16 bits: an unsigned float of 6 bits exponent and 10 bits mantissa, relative error at most 2^-11 from
/// 2^-31 to 4.29e9, absolute error at most 2^-42 below. Codes order as their energies do. The three codes above
/// highest_energy_code stand for no energy.
inline constexpr std::uint16_t highest_energy_code = 0xFFFC;
/// A vertex that no seam may pass.
inline constexpr std::uint16_t protected_code = 0xFFFD;
/// A vertex that seams take first.
inline constexpr std::uint16_t attracted_code = 0xFFFE;
/// What encode_energy makes of a negative, infinite, too large or undefined energy.
inline constexpr std::uint16_t invalid_energy_code = 0xFFFF;

/// The nearest code.
inline std::uint16_t encode_energy(float energy) {
    if (!(energy >= 0)) return invalid_energy_code;
    if (energy < 0x1p-31f) return static_cast<std::uint16_t>(std::lrint(energy * 0x1p41f));
    const auto bits = std::bit_cast<std::uint32_t>(energy);
    const auto code = ((bits + 0xFFF + ((bits >> 13) & 1)) >> 13) - (95u << 10);
    return code <= highest_energy_code ? static_cast<std::uint16_t>(code) : invalid_energy_code;
}

/// @param code  of an energy
inline float decode_energy(std::uint16_t code) { return code < 1024 ? static_cast<float>(code) * 0x1p-41f : std::bit_cast<float>((code + (95u << 10)) << 13); }

}  // namespace fluidcarve
