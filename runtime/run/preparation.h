#pragma once

#include "graph/types/registry.h"
#include "runtime/keep/store.h"
#include "runtime/plan/plan.h"
#include "runtime/run/flow.h"
#include "runtime/tell/report.h"

#include <optional>
#include <vector>

namespace fluidcarve {

/// All that is known of a run before it starts: which frames there are, what of them is computed, and what is there already.
class Preparation {
public:
    /// Looks at the inputs. Warnings go to the report.
    /// @param wish     without fault
    /// @param deliver  what per-frame nodes deliver; nothing: all
    Preparation(const Pipeline& pipeline, const Registry& registry, const RunOptions& options, const Wish& wish, const std::optional<FrameSet>& deliver,
                Report& report);

    const Plan& plan() const { return plan_; }
    const std::vector<int>& frames() const { return frames_; }         ///< the sequence, frames that readers leave out removed
    const std::vector<bool>& delivered() const { return delivered_; }  ///< per place
    std::vector<int> delivered_frames() const;
    const std::vector<Fault>& missing() const { return missing_; }  ///< inputs that are not there, or unreadable
    /// Per place: whether the run looks at the node's files there.
    std::vector<bool> reads(std::size_t node) const;
    /// Per reader: memory of the largest frame, by what its file says.
    const std::map<std::size_t, std::uint64_t>& input_bytes() const { return input_bytes_; }
    Cache& cache() { return cache_; }
    Store& store() { return store_; }
    Keys& keys() { return keys_; }

    Schedule schedule();
    /// After kept results turned out to be damaged or gone: reads what it counts on, and counts on nothing that is yet to be kept.
    Schedule careful_schedule();
    /// As if nothing were there.
    Schedule whole_schedule() const;
    /// Puts into the report what was said when the results were made that are not made again.
    void repeat_said(const Schedule& schedule, Report& report);

private:
    bool wants(std::size_t node, std::size_t place) const;
    Schedule schedule(bool careful);

    const Pipeline& pipeline_;
    Plan plan_;
    std::vector<int> frames_;
    std::vector<bool> delivered_;
    std::vector<Fault> missing_;
    std::map<std::size_t, std::map<int, int>> stand_ins_;
    std::map<std::size_t, std::uint64_t> input_bytes_;
    std::vector<bool> every_;                                 ///< as flags: the nodes that run for every frame of the sequence
    std::vector<std::function<bool(const Context&)>> wants_;  ///< per node; empty: all
    Cache cache_;
    FileHashes files_;
    Keys keys_;
    Store store_;
};

}  // namespace fluidcarve
