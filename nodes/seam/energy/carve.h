#pragma once

#include "nodes/seams/carve_map.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace fluidcarve {

/// One frame's energy in the space that seams carved before leave: removed entries go, inserted ones are the mean of their
/// neighbours (METHOD 4), and marked if either is.
/// @param slab   as sample_energy fills it
/// @param shape  I, J, K of the slab, which the steps carve in their order
/// @param axis   along which the slab is contiguous; the steps' own may differ
std::vector<std::uint16_t> carve_energy(std::vector<std::uint16_t> slab, const std::array<int, 3>& shape, Axis axis, std::span<const CarveStep> steps);
/// The same for a field.
std::vector<std::uint16_t> carve_field(std::vector<std::uint16_t> slab, const std::array<int, 3>& shape, Axis axis, std::span<const CarveStep> steps);

}  // namespace fluidcarve
