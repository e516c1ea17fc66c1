#pragma once

#include "carve/seam/window.h"
#include "carve/solver/costs/energy_volume.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

namespace fluidcarve {

/// The paper's guide, in units of energy: `[k][distance from the entry in slice 0]`, up to the
/// reach of the cone in slice k.
using GuideTable = std::vector<std::vector<float>>;

GuideTable gaussians(int slices, double height);

template <class Cell>
double mean_energy(const EnergyVolume& energy, Window window) {
    const auto* const cells = energy.cells<Cell>(0);
    const auto row = static_cast<std::size_t>(energy.laterals());
    // Marked entries count 0.
    const auto energies = [](Cell cell) {
        const auto cost = EntryCosts{}(cell);
        return std::isinf(cost) ? 0.0f : std::max(cost, 0.0f);
    };
    // Slices are added in order, so that the sum does not depend on the threads.
    std::vector<double> sums(static_cast<std::size_t>(energy.slices()), 0.0);
    tbb::parallel_for(std::size_t{0}, sums.size(), [&](std::size_t k) {
        for (std::size_t c = k * row; c < (k + 1) * row; ++c)
            for (int entry = window.first; entry <= window.last; ++entry)
                sums[k] += energies(cells[c * energy.stride() + static_cast<std::size_t>(entry)]);
    });
    return std::accumulate(sums.begin(), sums.end(), 0.0) /
           (static_cast<double>(energy.columns_per_frame()) * window.size());
}

}  // namespace fluidcarve
