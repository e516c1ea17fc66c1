#pragma once

#include "graph/pipeline.h"
#include "runtime/keep/input_guard.h"
#include "runtime/keep/store.h"
#include "runtime/plan/schedule.h"
#include "runtime/plan/timelines.h"
#include "runtime/run/options.h"
#include "runtime/tell/costs.h"
#include "runtime/tell/profile.h"
#include "runtime/tell/progress.h"
#include "runtime/tell/report.h"

#include <functional>
#include <memory>

namespace fluidcarve {

/// Executes a schedule: nodes that run once, and the passes of its plan as TBB flow graphs. Holds
/// all results that outlive a pass.
class Flow {
public:
    /// @param store      cached results of former runs; receives those of this run
    /// @param guard      watches the input files
    /// @param costs      receives the cost of each node's work
    /// @param profile    may be null
    /// @param cancelled  called often; true: stop
    Flow(const Pipeline& pipeline, const Registry& registry, const Timelines& timelines,
         const RunOptions& options, Store& store, InputGuard& guard, Report& report,
         Progress& progress, WorkTimes& costs, RunProfile* profile,
         std::function<bool()> cancelled);
    ~Flow();

    /// Executes the schedule, pass after pass. Unless `keep_going`, no new frames start after a
    /// failure; frames in flight end.
    void run(const Plan& plan, const Schedule& schedule);

    /// Whether the run ended early: cancelled, failed without `keep_going`, or a gatherer lacks
    /// frames.
    bool stopped() const;
    /// Whether a cached result in the schedule was missing or damaged. The run then needs another
    /// schedule.
    bool lost() const;

private:
    struct Self;
    std::unique_ptr<Self> self_;
};

}  // namespace fluidcarve
