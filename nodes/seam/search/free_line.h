#pragma once

#include "nodes/seam/search/find_seams.h"

namespace fluidcarve {

/// As dynamic_seam, for columns in one open line between which steps are free: what is done hundreds of times for an image.
/// Keeps the ways to every 32nd column only and finds those between again around the seam.
Seams::Seam free_line_seam(const EnergyVolume& energy, Window window, int number);

}  // namespace fluidcarve
