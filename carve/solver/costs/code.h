#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace fluidcarve {

/// Energies are stored in 16 bits: an unsigned float with 6 bits of exponent and 10 bits of
/// mantissa. Its relative error is at most 2^-11 from 2^-31 to 4.29e9, its absolute error at most
/// 2^-42 below. Codes are ordered as their energies are. The three codes above highest_energy_code
/// stand for no energy.
inline constexpr std::uint16_t highest_energy_code = 0xFFFC;
/// Marks a vertex that no seam may pass.
inline constexpr std::uint16_t protected_code = 0xFFFD;
/// Marks a vertex that seams take first.
inline constexpr std::uint16_t attracted_code = 0xFFFE;
/// Code of a negative, infinite, too large or undefined energy.
inline constexpr std::uint16_t invalid_energy_code = 0xFFFF;

namespace detail {

/// The bits of a positive float without the lowest 13, rounded to even.
inline std::uint32_t upper_bits(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    return (bits + 0xFFF + ((bits >> 13) & 1)) >> 13;
}

}  // namespace detail

/// The code nearest to an energy.
inline std::uint16_t encode_energy(float energy) {
    if (!(energy >= 0)) return invalid_energy_code;
    if (energy < 0x1p-31f) return static_cast<std::uint16_t>(std::lrint(energy * 0x1p41f));
    const auto code = detail::upper_bits(energy) - (95u << 10);
    return code <= highest_energy_code ? static_cast<std::uint16_t>(code) : invalid_energy_code;
}

/// The energy that a code stands for.
/// @param code  at most highest_energy_code
inline float decode_energy(std::uint16_t code) {
    return code < 1024 ? static_cast<float>(code) * 0x1p-41f
                       : std::bit_cast<float>((code + (95u << 10)) << 13);
}

/// Field values are stored in 16 bits, as half floats. Their relative error is at most 2^-11 from
/// 2^-14 to highest_field, their absolute error at most 2^-25 below.
inline constexpr float highest_field = 65504;
/// Code of a value beyond highest_field, infinite or undefined.
inline constexpr std::uint16_t invalid_field_code = 0x7C00;

/// The code nearest to a value.
inline std::uint16_t encode_field(float value) {
    const float size = std::abs(value);
    if (!(size <= highest_field)) return invalid_field_code;
    const auto code = size < 0x1p-14f ? static_cast<std::uint32_t>(std::lrint(size * 0x1p24f))
                                      : detail::upper_bits(size) - (112u << 10);
    return static_cast<std::uint16_t>(code | (std::signbit(value) ? 0x8000u : 0u));
}

/// The value that a code stands for.
/// @param code  not invalid_field_code
inline float decode_field(std::uint16_t code) {
    const auto size = code & 0x7FFFu;
    const float value = size < 1024 ? static_cast<float>(size) * 0x1p-24f
                                    : std::bit_cast<float>((size + (112u << 10)) << 13);
    return (code & 0x8000u) != 0 ? -value : value;
}

}  // namespace fluidcarve
