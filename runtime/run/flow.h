#pragma once

#include "graph/pipeline.h"
#include "runtime/keep/store.h"
#include "runtime/plan/plan.h"
#include "runtime/tell/profile.h"
#include "runtime/tell/progress.h"
#include "runtime/tell/report.h"

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
    bool cache = true;                                                  ///< results are kept in the work folder, and taken from there
    std::uint64_t cache_size = std::uint64_t{50} * 1024 * 1024 * 1024;  ///< bytes that stay there after a run
};

/// Executes the parts of a plan: once-run nodes, and passes as TBB flow graphs. Holds what outlives a pass.
class Flow {
public:
    /// @param frames     the sequence, frames left out removed
    /// @param store      what former runs kept, and where this one's results go
    /// @param profile    null: none is made
    /// @param cancelled  asked often; true: stop
    Flow(const Pipeline& pipeline, const Registry& registry, const std::vector<int>& frames, const RunOptions& options, Store& store, Report& report,
         Progress& progress, RunProfile* profile, std::function<bool()> cancelled);
    ~Flow();

    /// Runs what the schedule says, pass after pass. A failed frame stops the admission of new ones unless `keep_going`; those in
    /// flight end.
    void run(const Plan& plan, const Schedule& schedule);

    /// Not all could run: a failure (not kept going), an interrupted run, a node without its frames.
    bool stopped() const;
    /// A kept result that the schedule counted on was gone or damaged: another schedule is needed.
    bool lost() const;

private:
    struct Self;
    std::unique_ptr<Self> self_;
};

}  // namespace fluidcarve
