#pragma once

#include "carve/seam/carve_map.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace fluidcarve {

/// Carves one frame's energy into the space that earlier seams and warps leave. Removed entries
/// disappear. An inserted entry is the mean of its neighbours (METHOD 4), and marked if either of
/// them is. Under a warp an entry lies between two vertices, and is marked if either of them is; an
/// entry without content has no energy.
/// @param codes   energy codes, laid out as by sample_columns()
/// @param shape   I, J, K of the frame at full size; the steps carve it in order
/// @param axis    along which the codes are contiguous; the steps' own axes may differ
/// @param finest  2: the codes and the result are at half size; each coarse entry moves as its
///   first vertex does
/// @return the carved codes, laid out the same way
std::vector<std::uint16_t> carve_energy(std::vector<std::uint16_t> codes,
                                        const std::array<int, 3>& shape, Axis axis,
                                        std::span<const CarveStep> steps, int finest);
/// The same for a field, in field codes.
std::vector<std::uint16_t> carve_field(std::vector<std::uint16_t> codes,
                                       const std::array<int, 3>& shape, Axis axis,
                                       std::span<const CarveStep> steps, int finest);

}  // namespace fluidcarve
