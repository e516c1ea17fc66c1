#include "carve/solver/task/params.h"

#include <algorithm>
#include <cstddef>

namespace fluidcarve {

namespace {

/// Lattices of more vertices are solved at half size, unless told otherwise.
constexpr std::size_t most_vertices_solved = 12'000'000;

}  // namespace

SolverParams params_for(const SolverParams& stated, bool has_field, std::size_t frames) {
    auto out = stated;
    if (out.axis == Axis::t && out.count.value != 0 && has_field && !out.window && frames > 2)
        out.window = VertexRange{1, static_cast<double>(frames) - 2};
    return out;
}

int finest_for(const SolverParams& params, const Lattice& lattice) {
    if (params.finest) return *params.finest;
    std::size_t vertices = 1;
    for (const int size : lattice.shape) vertices *= static_cast<std::size_t>(size);
    // Images are solved exactly, whatever their size, and seams of frames need whole frames.
    const bool halves = std::ranges::min(lattice.shape) > 1 && params.axis != Axis::t;
    return halves && vertices > most_vertices_solved ? 2 : 1;
}

}  // namespace fluidcarve
