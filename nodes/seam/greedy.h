#pragma once

#include "graph/types/node_type.h"
#include "nodes/seam/search/find_seams.h"

namespace fluidcarve {

/// What leads a seam through a closed lattice back to where it began.
enum class Guide {
    cone,      ///< at slice k only entries within K - k of the seam's entry in slice 0 (METHOD 8)
    gaussian,  ///< the cone, and the paper's inverted Gaussian added to the energy (paper 4.0.1)
};

/// One seam by the paper's multi-greedy search (section 4, Fig. 11 and 13). Each of `starts` seams begins at an entry
/// of its own in the first column, at the centres of as many equal parts of the window, and goes along the rows, then
/// the slices, then the frames; in each column it takes the cheapest entry within 1 of its entries in the neighbours
/// already passed (before it in the row, in the slice, in time). Ties: the entry of the nearest neighbour, then the side
/// below it for even `number`, above it for odd. The cheapest finished seam wins, of equals the first.
/// Through a closed energy, seams close: the guide's cone always holds an entry that all neighbours allow. The Gaussian
/// stands on the entry in slice 0, is half as wide as the cone there, and as high as the window's mean energy in the first
/// frame; it bends the way and does not count as energy.
/// Where vertices are marked, costs (Costs) stand in for energies. A search that protected vertices leave no way goes on
/// through one; if all have to, the one that passes fewest is moved aside (protection.h), which finds a way wherever there is one.
/// Deterministic. Takes 0.4 s for 322 x 105 x 331 vertices, 84 frames and 16 starts on two cores.
/// @param starts  at least 1; more than the window has entries means all of them
Seams::Seam greedy_seam(const EnergyVolume& energy, Window window, int number, int starts, const Tick& tick, Guide guide = Guide::cone);

/// `seam.greedy`: greedy_seam as a node.
NodeType seam_greedy();

}  // namespace fluidcarve
