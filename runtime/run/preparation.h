#pragma once

#include "graph/types/registry.h"
#include "runtime/keep/store.h"
#include "runtime/plan/schedule.h"
#include "runtime/run/flow.h"
#include "runtime/run/inputs.h"
#include "runtime/tell/report.h"

#include <optional>
#include <vector>

namespace fluidcarve {

/// All that is known of a run before it starts: the plan, what the readers say of their files, and which results are cached.
class Preparation {
public:
    /// Looks at the input files. Warnings go to the report.
    /// @param wish     must have no fault
    /// @param deliver  frames that per-frame nodes deliver; nothing: all
    Preparation(const Pipeline& pipeline, const Registry& registry, const RunOptions& options, const Wish& wish, const std::optional<FrameSet>& deliver,
                Report& report);

    const Plan& plan() const { return plan_; }
    const Inputs& inputs() const { return inputs_; }
    const std::vector<int>& frames() const { return inputs_.frames; }
    std::vector<int> delivered_frames() const;  ///< frame numbers
    /// Per place: whether the run reads the node's files.
    std::vector<bool> reads(std::size_t node) const;
    const Dependencies& dependencies() const { return dependencies_; }
    Cache& cache() { return cache_; }
    Store& store() { return store_; }

    Schedule schedule();
    /// For use after a cached result was missing or damaged: checks every byte of the entries it uses, and does not expect to load
    /// results that this run is yet to compute.
    Schedule careful_schedule();
    /// The schedule with an empty cache.
    Schedule uncached_schedule() const;
    /// Adds to the report the warnings and entries of all cached results that the schedule uses.
    void repeat_said(const Schedule& schedule, Report& report);

private:
    bool wants(std::size_t node, std::size_t place) const;
    Schedule schedule(bool careful);

    const Pipeline& pipeline_;
    const Plan plan_;
    const Inputs inputs_;
    const std::vector<bool> delivered_;  ///< per place in `frames()`
    Cache cache_;
    FileHashes files_;
    const Dependencies dependencies_;
    Keys keys_;
    Store store_;
};

}  // namespace fluidcarve
