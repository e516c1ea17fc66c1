#pragma once

#include "carve/solver/costs/energy_volume.h"
#include "carve/solver/costs/marks.h"
#include "carve/solver/search/find_seams.h"
#include "carve/solver/task/space.h"
#include "carve/solver/task/task.h"
#include "graph/types/context.h"
#include "nodes/solving/reported_seams.h"

#include <chrono>
#include <optional>

namespace fluidcarve {

/// Inputs of a search, besides its energy.
struct SearchSetup {
    const SeamTask& task;
    const CarvedSpace& space;
    const Seams& empty;           ///< empty_seams()
    const ReportedSeams& before;  ///< found by an earlier run, no more than the task wants
    const MarkCounts& marks;
    const FindSeam& find;
    const StartFrom& start_from;
    std::optional<int> bound_passes;  ///< passes of lower_bound(); nothing: as few as possible,
                                      ///< and in large energies only for the first seam
    /// Shortest time between two calls of Context::checkpoint.
    std::chrono::milliseconds checkpoint_after;
    /// Accept fewer seams than the task wants, if no more are possible.
    bool best_effort = false;
    std::optional<Thick> thick = {};  ///< nothing: seams are thin
};

/// Finds all seams of a task; with `best_effort` perhaps fewer, and the report says why. Meanwhile
/// passes the seams found so far, with their report, to Context::checkpoint.
/// @param energy  is consumed
/// @throws Failure saying why no more seams are possible; as find_seams()
ReportedSeams solve_task(EnergyVolume& energy, const SearchSetup& setup, const Context& context);

}  // namespace fluidcarve
