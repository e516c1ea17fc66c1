#pragma once

#include "graph/pipeline.h"
#include "runtime/plan.h"
#include "runtime/progress.h"
#include "runtime/report.h"

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace fluidcarve {

/// Limits and wishes of one run.
struct RunOptions {
    int threads = 1;
    int in_flight = 2;         ///< frames alive at once
    std::uint64_t memory = 0;  ///< bytes for what nodes hold for the whole sequence
    std::string work_folder = ".fluidcarve";
    bool keep_going = false;
};

/// Executes the parts of a plan: once-run nodes, and passes as TBB flow graphs. Holds what outlives a pass.
class Flow {
public:
    /// @param frames     the sequence, frames left out removed
    /// @param cancelled  asked often; true: stop
    Flow(const Pipeline& pipeline, const Registry& registry, const std::vector<int>& frames, const RunOptions& options, Report& report, Progress& progress,
         std::function<bool()> cancelled);
    ~Flow();

    /// Tells the progress of all that the plan will run.
    void announce(const Plan& plan, const std::vector<bool>& delivered);
    /// Runs nodes that run once, in order. Stops at the first failure.
    void run_once(const std::vector<std::size_t>& nodes);
    /// Streams the frames. A failed frame stops the admission of new ones unless `keep_going`; those in flight end.
    /// @param delivered  per place in the sequence
    void run_pass(const Pass& pass, const std::vector<bool>& delivered, const std::vector<bool>& targets);

    /// No further part of the plan can run: a failure (not kept going), an interrupted run, a node without its frames.
    bool stopped() const;

private:
    struct Self;
    std::unique_ptr<Self> self_;
};

}  // namespace fluidcarve
