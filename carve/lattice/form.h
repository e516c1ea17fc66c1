#pragma once

#include <array>

namespace fluidcarve {

/// The part of a lattice that windows and counts refer to. It may be known before the run.
struct LatticeForm {
    std::array<int, 3> shape{};  ///< I, J, K; 0: not known
    bool closed = false;         ///< as of Lattice
    bool around = false;
    int frames = 0;  ///< of the sequence, which seams of frames count; 0: not known
};

}  // namespace fluidcarve
