#pragma once

#include <array>

namespace fluidcarve {

/// What of a lattice windows and counts refer to; known before the lattice is.
struct LatticeForm {
    std::array<int, 3> shape{};  ///< I, J, K; 0: not known
    bool closed = false;         ///< as of Lattice
    bool around = false;
};

}  // namespace fluidcarve
