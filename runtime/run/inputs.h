#pragma once

#include "carve/base/frame_set.h"
#include "graph/outlooks.h"
#include "runtime/plan/plan.h"
#include "runtime/plan/timelines.h"
#include "runtime/tell/report.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace fluidcarve {

/// Facts of a run's readers about their files before the run, and the consequences for other
/// nodes.
struct Inputs {
    Timelines timelines;  ///< the frames of each node, without those that readers leave out
    std::vector<NodeFailure> missing;  ///< files and grids that are missing or unreadable
    /// Pictures of different sizes that meet in a node; bodies do not check this.
    std::vector<NodeFailure> clashes;
    /// Per node: frame to the frame whose file it uses instead of its own.
    std::map<std::size_t, std::map<int, int>> stand_ins;
    /// Regions of outputs, as far as readers state them.
    ReadRegions regions;
    /// Largest frame of a reader in memory, estimated from its file; 0: unknown.
    std::uint64_t frame_bytes = 0;
};

/// Calls the survey of each node that the run needs. Warnings go to the report.
/// @param deliver  frames that per-frame nodes deliver; nothing: all
/// @param cache    whether the run caches results
Inputs survey_inputs(const Pipeline& pipeline, const Plan& plan,
                     const std::optional<FrameSet>& deliver, bool cache, Report& report);

}  // namespace fluidcarve
