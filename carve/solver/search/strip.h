#pragma once

#include "carve/solver/costs/lanes.h"
#include "carve/solver/search/band.h"
#include "carve/solver/search/columns.h"
#include "carve/solver/search/kept_memory.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace fluidcarve {

/// The energies of a band of equal width, column after column. They are read again and again while
/// a seam is refined. If vertices are marked, EntryCosts replace energies.
class Strip {
public:
    /// @param band    intervals of one size
    /// @param memory  of its arrays
    Strip(const EnergyVolume& energy, Band band, const KeptMemory& memory = {});

    const Columns& columns() const { return columns_; }
    Band::Column operator[](std::size_t column) const { return band_.columns[column]; }
    const Band& band() const { return band_; }
    std::size_t width() const { return width_; }  ///< entries of a column
    /// The energies of a column, from its interval's first entry on.
    const float* energies(std::size_t column) const {
        return energies_.data() + margin + column * width_;
    }
    float energy(std::size_t column, int entry) const {
        return energies(column)[entry - band_.columns[column].first];
    }
    /// The energies of four entries, the first of them at most 2 before or behind the column's
    /// interval. Values outside the interval are meaningless.
    Lanes energies(std::size_t column, int entry) const {
        return load_values(energies(column) + (entry - band_.columns[column].first));
    }
    /// Sum over a seam in the band, including the costs of its steps.
    double energy(std::span<const std::uint16_t> seam) const;
    /// The costs of steps; points into the energy that the strip was made from.
    const StepCosts& steps() const { return steps_; }
    /// The field, if steps have one, from one entry before a column's interval to one behind it.
    float field(std::size_t column, int entry) const { return fields_[field_place(column, entry)]; }
    /// The field of a column, likewise.
    const float* fields(std::size_t column) const {
        return fields_.data() + margin + column * (width_ + 2);
    }
    /// The same of four entries, as for energies().
    Lanes fields(std::size_t column, int entry) const {
        return load_values(fields_.data() + field_place(column, entry));
    }
    bool protects() const { return protects_; }

private:
    /// Floats that lanes may read before the first and behind the last column.
    static constexpr std::size_t margin = 8;

    std::size_t field_place(std::size_t column, int entry) const {
        return margin + column * (width_ + 2) +
               static_cast<std::size_t>(entry + 1 - band_.columns[column].first);
    }

    Columns columns_;
    Band band_;
    std::size_t width_;
    KeptMemory::Array<float> energies_;  ///< `[column][entry]` between two margins
    StepCosts steps_;
    /// The field likewise, with one more entry at either end; empty: no field.
    KeptMemory::Array<float> fields_;
    bool protects_;
};

/// Sum of the costs of a seam's steps. Like all sums here, it is the same for any number of
/// threads.
double cost_of_steps(const Columns& columns, const StepCosts& steps,
                     std::span<const std::uint16_t> seam);
/// Energy of a seam: the sum over its entries and the costs of its steps. Attracted vertices count
/// 0.
double energy_of(const EnergyVolume& energy, std::span<const std::uint16_t> seam);
/// Cost of a seam: the same sum with EntryCosts.
double cost_of(const EnergyVolume& energy, std::span<const std::uint16_t> seam);
/// Lower bound on the energy of any seam that takes as many attracted vertices as `seam`.
/// @param cost_bound  lower bound on the cost of any seam
double energy_bound(const EnergyVolume& energy, std::span<const std::uint16_t> seam,
                    double cost_bound);

}  // namespace fluidcarve
