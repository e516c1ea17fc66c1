#pragma once

#include "carve/stream/stored.h"
#include "carve/volume/volume.h"

namespace fluidcarve {

/// Trees shared by several grids count once.
template <>
struct Stored<Volume> {
    static std::uint64_t bytes(const Volume& volume);
    static void write(const Volume& volume, std::ostream& to);
    static Ref<Volume> read(std::istream& from);
};

}  // namespace fluidcarve
