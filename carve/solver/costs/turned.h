#pragma once

#include "carve/solver/costs/energy_volume.h"

namespace fluidcarve {

/// An energy with time and `u` exchanged, for seams of frames (Axis::t): the entries of a column
/// `(j, k)` are its frames, and each vertex along u takes the place of a frame. Prices of
/// steps, spread and marks are not set.
/// @param from    of Axis::u, at full or half size
/// @param limits  of the energies; the field may take as much again
/// @throws Failure as FrameStore
EnergyVolume turned(const EnergyVolume& from, const Limits& limits);

}  // namespace fluidcarve
