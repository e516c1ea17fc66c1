#pragma once

#include "nodes/seam/search/band.h"
#include "nodes/seam/search/columns.h"

#include <cstdint>
#include <span>
#include <vector>

namespace fluidcarve {

/// An energy at half the resolution: along the carved axis, and along each lateral dimension and time of more than one. An
/// entry's energy is the mean, over its columns, of what a seam pays that can choose between the column's two entries
/// (METHOD 8 "Restriction"). Protected vertices are dear and no more, since what is free may be narrower than an entry;
/// attracted ones count by their share. Steps cost as much for each entry, since a coarse step stands for two fine ones in half as
/// many columns.
/// @param window  the entries that are kept; entry i of the result stands for window.first + 2i and the next
EnergyVolume restrict_energy(const EnergyVolume& energy, Window window);

/// A seam found at half the resolution, in the columns of the finer one: interpolated linearly and rounded down, which
/// keeps neighbours within 1.
/// @param coarse  entries of restrict_energy's result
/// @param fine    the columns of what was restricted
std::vector<std::uint16_t> prolong_seam(const Columns& coarse, std::span<const std::uint16_t> seam, const Columns& fine, Window window);

}  // namespace fluidcarve
