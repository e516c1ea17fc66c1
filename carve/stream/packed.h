#pragma once

#include "carve/stream/binary.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace fluidcarve {

/// Writes 16-bit numbers compressed. The more neighbours are alike, the fewer bytes.
void write_packed(std::span<const std::uint16_t> numbers, BinaryWriter& to);
/// Reads what write_packed() wrote.
/// @throws Failure if it is damaged, or holds another number of them
std::vector<std::uint16_t> read_packed(std::size_t count, BinaryReader& from);

}  // namespace fluidcarve
