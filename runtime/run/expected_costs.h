#pragma once

#include "runtime/flow/options.h"
#include "runtime/keep/grown_result.h"
#include "runtime/keep/history.h"
#include "runtime/plan/schedule.h"
#include "runtime/tell/costs.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace fluidcarve {

/// The costs of each node, as earlier runs measured them, converted to the setting of this run:
/// its threads, bytes, frames and items to find.
/// @param input_bytes  Inputs::frame_bytes of the run
/// @param grown  per node: how much of its growing result is kept
/// @param work  one per node
std::vector<NodeCost> expected_costs(const Pipeline& pipeline, std::uint64_t input_bytes,
                                     const std::vector<std::optional<GrownResult>>& grown,
                                     const std::vector<NodeWork>& work, const History& history,
                                     const RunOptions& options);

/// Expected wall seconds of a node's work in a run, or in a part of one.
/// @param cost  in the setting of the run
/// @param known  set to false if a cost is unknown
double expected_seconds(const NodeCost& cost, const NodeWork& work, bool& known);

}  // namespace fluidcarve
