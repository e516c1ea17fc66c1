#pragma once

#include "tests/bench/similarity.h"

/// An image carved along u by liblqr, with the energy that it comes with.
/// @param image  one frame, one plane; `[v][u]`
/// @param width  vertices along u of the result
/// @throws std::runtime_error if liblqr fails
Samples carve_by_lqr(const Samples& image, std::size_t width);
