#pragma once

#include "carve/solver/search/find_seams.h"
#include "carve/solver/search/open_line.h"

#include <memory>

namespace fluidcarve {

/// Whether all columns stand in one line with two ends.
bool in_open_line(const EnergyVolume& energy);

/// Finds seams of least energy in a volume whose columns stand in one line, as in images, by
/// dynamic programming (Avidan and Shamir 2007). Ties are resolved as in greedy_seam(). A closed
/// line is solved by a minimum cut. Of consecutive seams of find_seams(), each reuses the costs
/// kept from the last one; copies share these costs.
class DynamicSeams {
public:
    /// @throws Failure if columns stand beside each other in more than one dimension
    Seams::Seam operator()(const EnergyVolume& energy, Window window, int number,
                           const Tick& tick) const;

private:
    std::shared_ptr<OpenLine> line_ = std::make_shared<OpenLine>();
};

}  // namespace fluidcarve
