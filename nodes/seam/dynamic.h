#pragma once

#include "graph/types/node_type.h"
#include "nodes/seam/search/find_seams.h"

namespace fluidcarve {

/// Whether the columns stand in one line, which has two ends.
bool in_open_line(const EnergyVolume& energy);

/// The seam of least energy in a volume whose columns stand in one line, as an image's do: dynamic programming (Avidan and
/// Shamir 2007). Ties as greedy_seam. Through a ring by a minimum cut.
/// @throws Failure if columns stand beside each other in more than one dimension
Seams::Seam dynamic_seam(const EnergyVolume& energy, Window window, int number, const Tick& tick);

/// `seam.dynamic`: dynamic_seam as a node.
NodeType seam_dynamic();

}  // namespace fluidcarve
