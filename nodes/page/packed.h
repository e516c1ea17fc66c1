#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace fluidcarve {

/// Bytes for a page's script: compressed by gzip, as base64. The same bytes give the same text.
/// @throws Failure if they can't be compressed
std::string packed(std::span<const std::uint8_t> bytes);

/// Appends each value's difference from the one before, modulo 256. Values that change slowly
/// compress well so.
void append_differences(std::vector<std::uint8_t>& bytes, std::span<const std::uint8_t> values);
/// The same for numbers of 16 bits, modulo 65536: the lower bytes of all differences, then the
/// upper ones.
void append_differences(std::vector<std::uint8_t>& bytes, std::span<const std::uint16_t> values);
/// Appends numbers of 64 bits, lowest byte first.
void append_numbers(std::vector<std::uint8_t>& bytes, std::span<const double> values);

}  // namespace fluidcarve
