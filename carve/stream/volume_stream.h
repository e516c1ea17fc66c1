#pragma once

#include "carve/base/values.h"
#include "carve/volume/volume.h"

#include <cstdint>
#include <istream>
#include <ostream>

namespace fluidcarve {

/// Bytes of memory of a volume. Trees shared by several grids count once.
std::uint64_t bytes_of(const Volume& volume);

/// Writes a volume bit for bit as in memory (GridWriter).
void write_volume(const Volume& volume, std::ostream& to);
/// Reads what write_volume() wrote. @throws Failure if the stream holds no whole volume
Ref<Volume> read_volume(std::istream& from);

}  // namespace fluidcarve
