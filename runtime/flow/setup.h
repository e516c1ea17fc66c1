#pragma once

#include "graph/pipeline.h"
#include "runtime/flow/options.h"
#include "runtime/flow/run_events.h"
#include "runtime/keep/input_guard.h"
#include "runtime/keep/store.h"
#include "runtime/plan/timelines.h"

#include <functional>

namespace fluidcarve {

/// What a flow works with.
struct FlowSetup {
    const Pipeline& pipeline;
    const Registry& registry;
    const Timelines& timelines;
    const RunOptions& options;
    Store& store;       ///< cached results of former runs; receives those of this run
    InputGuard& guard;  ///< watches the input files
    RunEvents& events;
    std::function<bool()> cancelled;  ///< called often; true: stop
};

}  // namespace fluidcarve
