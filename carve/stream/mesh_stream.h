#pragma once

#include "carve/mesh/mesh.h"
#include "carve/stream/stored.h"

namespace fluidcarve {

template <>
struct Stored<Mesh> {
    static std::uint64_t bytes(const Mesh& mesh);
    static void write(const Mesh& mesh, std::ostream& to);
    static Ref<Mesh> read(std::istream& from);
};

}  // namespace fluidcarve
