#pragma once

#include "carve/solver/search/find_seams.h"

#include <optional>

namespace fluidcarve {

/// How a seam through a closed lattice is led back to its start.
enum class Guide {
    cone,      ///< at slice k only entries within K - k of the seam's entry in slice 0 (METHOD 8)
    gaussian,  ///< the cone, and the paper's inverted Gaussian added to the energy (paper 4.0.1)
};

/// Finds one seam by the paper's multi-greedy search (section 4, Fig. 11 and 13). The window is
/// divided into `starts` equal parts, and a seam starts at the centre of each part in the first
/// column. It goes along the rows, then the slices, then the frames. In each column it takes the
/// cheapest entry within 1 of its entries in the neighbours already passed (before it in the row,
/// in the slice, in time). Ties go to the entry of the nearest neighbour, then to the side below it
/// for even `number`, above it for odd. The cheapest finished seam wins; of equals, the first.
/// In a closed energy, seams close: the guide's cone always holds an entry that all neighbours
/// allow. The Gaussian is centred on the entry in slice 0. It is half as wide as the cone in each
/// slice, and as high as the window's mean energy in the first frame. It steers the seam and does
/// not count as energy.
/// If vertices are marked, costs (EntryCosts) replace energies. A search blocked by protected
/// vertices passes through one of them. If they block all searches, the seam that passes fewest is
/// moved aside (search/protection.h), which finds a way if there is one. Deterministic. Takes 0.4 s
/// for 322 x 105 x 331 vertices, 84 frames and 16 starts on two cores.
/// @param number  number of seams found before
/// @param starts  at least 1; at most one per entry of the window is used
Seams::Seam greedy_seam(const EnergyVolume& energy, Window window, int number, int starts,
                        const Tick& tick, Guide guide = Guide::cone);

/// The same seam, or none if it costs more than `most`. A search stops as soon as that is certain.
/// @param bounds  with the lower bound already found for this seam; null: none
std::optional<Seams::Seam> greedy_seam_within(const EnergyVolume& energy, Window window, int number,
                                              int starts, double most, const Tick& tick,
                                              const SeamBounds* bounds = nullptr);

}  // namespace fluidcarve
