#pragma once

#include "carve/solver/search/band.h"
#include "carve/solver/search/columns.h"

#include <cstdint>
#include <span>
#include <vector>

namespace fluidcarve {

/// Restricts an energy to half the resolution: along the carved axis, and along time and each
/// lateral dimension of more than one column. A coarse entry stands for two fine entries of each
/// of its columns. Its energy is the mean, over these columns, of the cost for a seam that can
/// choose between the two (METHOD 8 "Restriction"). Where seams are sought, protected vertices get
/// a high but finite cost, since a free passage may be narrower than a coarse entry. Attracted
/// vertices count by their share. A step costs as much as before: a coarse step stands for two
/// fine ones, in half as many columns.
/// @param window   the entries used; coarse entry i stands for window.first + 2i and the next one
/// @param barrier  cost of two protected vertices in a column: energy.barrier() where seams are
///   sought. With infinity, a coarse entry stays protected if all its vertices are; else it gets
///   the mean over the columns with a free vertex.
EnergyVolume restrict_energy(const EnergyVolume& energy, Window window, float barrier);

/// Interpolates a seam found at half the resolution to the columns of the finer one: linearly,
/// rounded down, which keeps neighbours within 1.
/// @param coarse  columns of the restricted energy
/// @param seam    entries in the restricted energy
/// @param fine    columns of the energy that was restricted
/// @param window  as for restrict_energy()
std::vector<std::uint16_t> prolong_seam(const Columns& coarse, std::span<const std::uint16_t> seam,
                                        const Columns& fine, Window window);

}  // namespace fluidcarve
