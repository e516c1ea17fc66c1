#pragma once

#include <cstdint>
#include <span>

namespace fluidcarve {

/// decode_energy() of many codes, by vector instructions.
/// @param codes  at most highest_energy_code; others decode to meaningless numbers
/// @param out    as many
void decode_energies(std::span<const std::uint16_t> codes, std::span<float> out);

/// decode_field() of many codes, by vector instructions.
/// @param out  as many
void decode_fields(std::span<const std::uint16_t> codes, std::span<float> out);

}  // namespace fluidcarve
