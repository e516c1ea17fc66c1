#pragma once

#include <cstddef>

namespace fluidcarve {

/// Whether a preview shows a frame: the first, the last, and others in even steps between; a single
/// one is the middle frame.
/// @param t       index of the frame in the sequence
/// @param total   number of frames of the sequence
/// @param wanted  number of frames to show, above 0
bool is_shown(std::size_t t, std::size_t total, int wanted);

}  // namespace fluidcarve
