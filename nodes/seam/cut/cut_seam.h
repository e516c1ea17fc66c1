#pragma once

#include "nodes/seam/cut/cut.h"
#include "nodes/seam/search/strip.h"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace fluidcarve {

struct CutSeam {
    std::vector<std::uint16_t> at;
    double lower_bound = 0;  ///< no seam in the band costs less
};

/// The seam of least energy in a band, by a minimum cut (cut.h); of least cost, where vertices are marked (Costs). Energies
/// become whole numbers, 24 bits for the highest in the band.
/// @param band       of all columns; there is a seam in it
/// @param tolerance  how much above the least the seam may be, as a share of it
/// @param number     ties lean to one side for even numbers, to the other for odd
CutSeam cut_seam(const EnergyVolume& energy, const Band& band, double tolerance, int number, const std::function<void()>& tick);

/// The exact seam of a window. Where vertices are attracted, its lower bound is that of seams that take as many.
Seams::Seam exact_seam(const EnergyVolume& energy, Window window, int number, const std::function<void()>& tick);

/// The paper's way to long sequences, from Flynn et al., for comparison: the sequence is cut interval by interval, each as
/// the one before allows, and moved aside where protected vertices would leave no way on.
/// @param interval   frames, at least 1
/// @param threshold  energies below it count as none
Seams::Seam keyframed_seam(const EnergyVolume& energy, Window window, int number, int interval, double threshold, const std::function<void()>& tick);

/// The same in the part of a strip that lies within `radius` entries of a seam.
CutSeam cut_seam(const Strip& strip, std::span<const std::uint16_t> seam, int radius, double tolerance, int number, const std::function<void()>& tick);

}  // namespace fluidcarve
