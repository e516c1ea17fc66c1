#pragma once

#include "tests/bench/similarity.h"

#include <cstddef>
#include <string>
#include <vector>

/// A row of a picture of how carves look: what is seen, and what each is. All have the exposure of
/// the first.
struct LookRow {
    std::string title;
    std::vector<Samples> samples;  ///< of one frame each
    std::vector<std::string> names;
};

/// One frame of a sequence.
Samples frame_of(const Samples& samples, std::size_t t);

/// Draws rows below each other in a PNG, in lattice space: u to the right; w upwards, of flat
/// lattices v, of images the image. Volumes are lit from above and seen along v.
/// @throws fluidcarve::Failure if the file can't be written
void draw_looks(const std::vector<LookRow>& rows, const std::string& path);
