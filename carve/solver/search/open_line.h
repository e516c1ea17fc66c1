#pragma once

#include "carve/solver/search/find_seams.h"

#include <memory>

namespace fluidcarve {

/// Finds the seams of columns in one open line, as DynamicSeams, one after the other. It keeps
/// the costs of the cheapest paths to every 32nd column, and recomputes those between around the
/// seam. The next seam begins with these costs: only paths that the deleted seam may have changed
/// are followed again, as long as they differ from before. This does not change the seams.
class OpenLine {
public:
    OpenLine();
    ~OpenLine();
    OpenLine(const OpenLine&) = delete;
    OpenLine& operator=(const OpenLine&) = delete;

    /// @param number  of seams found before. If it is one more than at the last call, for the same
    ///   energy and the same window without its last entry, then only the last seam may have been
    ///   deleted since (find_seams())
    Seams::Seam operator()(const EnergyVolume& energy, Window window, int number);

private:
    struct Self;
    std::unique_ptr<Self> self_;
};

}  // namespace fluidcarve
