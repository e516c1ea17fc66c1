#pragma once

#include "graph/types/registry.h"
#include "runtime/keep/store.h"
#include "runtime/plan/schedule.h"
#include "runtime/run/flow.h"
#include "runtime/tell/report.h"

#include <optional>
#include <vector>

namespace fluidcarve {

/// All that is known of a run before it starts: the plan, the available frames, and which results are cached.
class Preparation {
public:
    /// Looks at the input files. Warnings go to the report.
    /// @param wish     must have no fault
    /// @param deliver  frames that per-frame nodes deliver; nothing: all
    Preparation(const Pipeline& pipeline, const Registry& registry, const RunOptions& options, const Wish& wish, const std::optional<FrameSet>& deliver,
                Report& report);

    const Plan& plan() const { return plan_; }
    const std::vector<int>& frames() const { return frames_; }         ///< frame numbers of the sequence, without the frames that readers leave out
    const std::vector<bool>& delivered() const { return delivered_; }  ///< per place in `frames()`: whether it is delivered
    std::vector<int> delivered_frames() const;                         ///< frame numbers
    const std::vector<Fault>& missing() const { return missing_; }     ///< input files that are missing or unreadable
    /// Per place: whether the run reads the node's files.
    std::vector<bool> reads(std::size_t node) const;
    /// Reader to the bytes of its largest frame in memory, estimated from its files.
    const std::map<std::size_t, std::uint64_t>& input_bytes() const { return input_bytes_; }
    Cache& cache() { return cache_; }
    Store& store() { return store_; }
    Keys& keys() { return keys_; }

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
    Plan plan_;
    std::vector<int> frames_;
    std::vector<bool> delivered_;
    std::vector<Fault> missing_;
    std::map<std::size_t, std::map<int, int>> stand_ins_;
    std::map<std::size_t, std::uint64_t> input_bytes_;
    std::vector<bool> every_;  ///< per node: whether it is needed in every frame of the sequence
    Cache cache_;
    FileHashes files_;
    Keys keys_;
    Store store_;
};

}  // namespace fluidcarve
