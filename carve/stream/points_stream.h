#pragma once

#include "carve/points/points.h"
#include "carve/stream/stored.h"

namespace fluidcarve {

template <>
struct Stored<Points> {
    static std::uint64_t bytes(const Points& points);
    static void write(const Points& points, std::ostream& to);
    static Ref<Points> read(std::istream& from);
};

}  // namespace fluidcarve
