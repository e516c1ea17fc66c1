#pragma once

#include "carve/solver/cut/cut.h"
#include "carve/solver/search/strip.h"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace fluidcarve {

/// A seam found by a minimum cut.
struct CutSeam {
    std::vector<std::uint16_t> at;  ///< entry per column, as Seams::Seam::at
    double lower_bound = 0;         ///< on the cost of any seam in the band
};

/// Finds the seam of least energy in a band by a minimum cut (cut.h); if vertices are marked, the
/// seam of least cost (EntryCosts). Energies become integers of up to 24 bits for the highest in
/// the band.
/// @param band       of all columns; holds at least one seam
/// @param tolerance  by how much the seam may exceed the least cost, as a share of it
/// @param number     number of seams found before; ties lean to one side for even numbers, to the
///   other for odd
CutSeam cut_seam(const EnergyVolume& energy, const Band& band, double tolerance, int number,
                 const std::function<void()>& check);

/// Finds the exact seam of a window. If vertices are attracted, its lower bound holds for seams
/// that take as many.
Seams::Seam exact_seam(const EnergyVolume& energy, Window window, int number,
                       const std::function<void()>& check);

/// The paper's method for long sequences (from Flynn et al.), for comparison. The sequence is cut
/// interval by interval, each continuing the one before. A seam is moved aside if protected
/// vertices would block the next interval.
/// @param interval   frames, at least 1
/// @param threshold  energies below it count as 0
Seams::Seam keyframed_seam(const EnergyVolume& energy, Window window, int number, int interval,
                           double threshold, const std::function<void()>& check);

/// cut_seam() in the part of a strip within `radius` entries of a seam.
CutSeam cut_seam(const Strip& strip, std::span<const std::uint16_t> seam, int radius,
                 double tolerance, int number, const std::function<void()>& check);

}  // namespace fluidcarve
