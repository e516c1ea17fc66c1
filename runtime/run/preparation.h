#pragma once

#include "carve/base/frame_set.h"
#include "graph/types/registry.h"
#include "runtime/keep/input_guard.h"
#include "runtime/keep/manifest.h"
#include "runtime/keep/store.h"
#include "runtime/plan/schedule.h"
#include "runtime/run/inputs.h"
#include "runtime/run/request.h"
#include "runtime/tell/report.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// All that is known of a run before it starts: the plan, the readers' facts about their files,
/// and which results are cached.
class Preparation {
public:
    /// Looks at the input files. Warnings go to the report.
    /// @param request   its target must have no fault
    /// @param manifest  the expected content of the input files; null: none
    Preparation(const Pipeline& pipeline, const Registry& registry, const RunRequest& request,
                Report& report, Manifest* manifest = nullptr);

    const Plan& plan() const { return plan_; }
    const Inputs& inputs() const { return inputs_; }
    const std::vector<int>& frames() const { return inputs_.timelines.frames(); }
    /// Why the inputs let no run begin; empty: they do.
    /// @param keep_going  a missing file is no reason, since its reader fails at its frame
    std::vector<NodeFailure> input_failures(bool keep_going) const;
    std::vector<int> delivered_frames() const;  ///< frame numbers
    /// Whether a gathering node takes frame `t`.
    bool takes(std::size_t node, std::size_t t) const;
    /// Whether a node that delivers per frame has frame `t`.
    bool delivers(std::size_t node, std::size_t t) const;
    /// Per frame: whether the run reads the node's files.
    std::vector<bool> reads(std::size_t node) const;
    const Dependencies& dependencies() const { return dependencies_; }
    Cache& cache() { return cache_; }
    Store& store() { return store_; }
    InputGuard& guard() { return guard_; }

    /// Why results that depend on an input file are not cached: its content could not be read when
    /// the run began. Empty: all contents are known.
    std::string fault_of_contents();

    /// Per node: how much of its growing result is kept, when the run begins.
    const std::vector<std::optional<GrownResult>>& grown() const { return grown_; }

    Schedule schedule();
    /// For use after a cached result was missing or damaged: checks every byte of the entries it
    /// uses, and does not expect to load results that this run is yet to compute.
    Schedule careful_schedule();
    /// The schedule with an empty cache.
    const Schedule& uncached_schedule() const { return uncached_schedule_; }
    /// What the nodes do in a schedule of this plan, of what they would do with an empty cache.
    /// @return one demand per node
    std::vector<NodeDemand> demands(const Schedule& schedule) const {
        return demands_of(pipeline_, plan_, schedule, uncached_schedule_);
    }
    /// Adds to the report the warnings and entries of all cached results that the schedule uses.
    void repeat_logs(const Schedule& schedule, Report& report);

private:
    /// Calls `see` for each file of the nodes that the run needs.
    void each_file(const std::function<void(std::size_t node, std::size_t t,
                                            const std::string& path)>& see) const;
    void compare(Manifest& manifest);
    Schedule schedule(bool careful);
    Schedule make_uncached_schedule() const;

    const Pipeline& pipeline_;
    const Plan plan_;
    InputGuard guard_;
    const Inputs inputs_;
    const std::vector<bool> delivered_;  ///< per frame in `frames()`
    const Schedule uncached_schedule_;   ///< made from the members above
    Cache cache_;
    FileHashes files_;
    const Dependencies dependencies_;
    Keys keys_;
    Store store_;
    std::vector<std::optional<GrownResult>> grown_;
    /// Files that differ from the manifest. Without the cache they are not compared here.
    std::vector<NodeFailure> unlike_manifest_;
};

}  // namespace fluidcarve
