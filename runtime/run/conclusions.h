#pragma once

#include "runtime/plan/timelines.h"
#include "runtime/tell/report.h"

#include <vector>

namespace fluidcarve {

/// Calls NodeType::conclude of each node whose frames are all known, with its reports of them.
/// Called once, after the last node has run.
/// @param demands  one per node
void conclude(const Pipeline& pipeline, const Timelines& timelines,
              const std::vector<NodeDemand>& demands, Report& report);

}  // namespace fluidcarve
