#pragma once

#include "nodes/seam/search/find_seams.h"

namespace fluidcarve {

/// As dynamic_seam(), for columns in one open line. It runs hundreds of times for an image. Keeps only the ways to every
/// 32nd column, and finds those between again around the seam.
Seams::Seam open_line_seam(const EnergyVolume& energy, Window window, int number);

}  // namespace fluidcarve
