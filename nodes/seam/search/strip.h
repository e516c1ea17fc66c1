#pragma once

#include "nodes/seam/search/band.h"
#include "nodes/seam/search/columns.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace fluidcarve {

/// The energies of a band of equal width, column after column: what is read again and again while a seam is refined. Where
/// vertices are marked, Costs stand in for energies.
class Strip {
public:
    /// @param band  intervals of one size
    Strip(const EnergyVolume& energy, const Band& band);

    const Columns& columns() const { return columns_; }
    Band::Column operator[](std::size_t column) const { return band_.columns[column]; }
    const Band& band() const { return band_; }
    /// At the interval's first entry; those of the others follow.
    const float* energies(std::size_t column) const { return energies_.data() + column * width_; }
    float energy(std::size_t column, int entry) const { return energies(column)[entry - band_.columns[column].first]; }
    /// Sum over a seam in the band, with its steps.
    double energy(std::span<const std::uint16_t> seam) const;
    /// What steps cost; points into the energy that the strip was made from.
    const StepCosts& steps() const { return steps_; }
    bool protects() const { return protects_; }

private:
    Columns columns_;
    Band band_;
    std::size_t width_;
    std::vector<float> energies_;
    StepCosts steps_;
    bool protects_;
};

/// What a seam's steps cost. The same for any number of threads, as all sums here.
double cost_of_steps(const Columns& columns, const StepCosts& steps, std::span<const std::uint16_t> seam);
/// Sum of the energies at a seam's entries and of what its steps cost; energies of attracted vertices are 0.
double energy_of(const EnergyVolume& energy, std::span<const std::uint16_t> seam);
/// Sum of the costs there and of what its steps cost.
double cost_of(const EnergyVolume& energy, std::span<const std::uint16_t> seam);
/// What no seam is below in energy that takes as many attracted vertices as this one.
/// @param cost_bound  what no seam is below in cost
double energy_bound(const EnergyVolume& energy, std::span<const std::uint16_t> seam, double cost_bound);

/// Makes a seam cheaper where a whole line of columns can do better while its neighbours stay: along each dimension, for
/// every line by dynamic programming (multi-pass dynamic programming, Furuta et al. 2018). Lines that are neighbours take turns.
/// @param seam  feasible, in the strip, of finite cost; stays so
/// @param turn  in a closed lattice, which slice holds still; another each time
void sweep_lines(const Strip& strip, std::vector<std::uint16_t>& seam, int turn);

}  // namespace fluidcarve
