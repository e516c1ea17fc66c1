#pragma once

#include "runtime/flow/body_calls.h"
#include "runtime/flow/cached_results.h"
#include "runtime/flow/once_calls.h"
#include "runtime/plan/plan.h"
#include "runtime/plan/schedule.h"

#include <cstddef>
#include <utility>
#include <vector>

namespace fluidcarve {

/// Executes a schedule: nodes that run once, and the passes of its plan, each as a TBB flow graph.
/// Holds all results that outlive a pass.
class Flow {
public:
    explicit Flow(FlowSetup setup)
        : setup_(std::move(setup)),
          held_(setup_.pipeline.nodes.size()),
          results_(setup_),
          bodies_(setup_, held_),
          once_(setup_, bodies_, results_, held_) {}

    /// Executes the schedule, pass after pass. Unless `keep_going`, no new frames start after a
    /// failure; frames in flight end.
    void run(const Plan& plan, const Schedule& schedule);

    /// Whether the run ended early: cancelled, failed without `keep_going`, or a gathering node
    /// lacks frames.
    bool stopped() const { return bodies_.stopped() || results_.lost(); }
    /// Whether a cached result in the schedule was missing or damaged. The run then needs another
    /// schedule.
    bool lost() const { return results_.lost(); }

private:
    void run_once(const std::vector<std::size_t>& nodes, const Plan& plan,
                  const Schedule& schedule);
    void run_pass(std::size_t pass, const Plan& plan, const Schedule& schedule);

    const FlowSetup setup_;
    PortIo::Outputs held_;  ///< of nodes that run once
    CachedResults results_;
    BodyCalls bodies_;
    OnceCalls once_;
};

}  // namespace fluidcarve
