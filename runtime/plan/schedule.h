#pragma once

#include "runtime/plan/plan.h"

#include <cstddef>
#include <functional>
#include <set>
#include <vector>

namespace fluidcarve {

/// What make_schedule asks about the cache and the nodes. `t` is an index in the sequence; 0
/// for nodes that deliver once.
struct ScheduleQueries {
    /// Whether the result is cached.
    std::function<bool(std::size_t node, std::size_t t)> result;
    /// Whether a gathering node's digest of the frame is cached.
    std::function<bool(std::size_t node, std::size_t t)> digest;
    /// Whether a gathering node takes the frame (NodeTraits::takes): only then it consumes it.
    std::function<bool(std::size_t node, std::size_t t)> takes;
    /// Whether a node that delivers per frame has the frame.
    std::function<bool(std::size_t node, std::size_t t)> delivers;
    /// Whether later passes can load a result that this run computes.
    std::function<bool(std::size_t node, std::size_t t)> keeps;
};

/// What each node will do in each frame of a run.
struct Schedule {
    /// How the run obtains a result.
    enum class Action : char {
        none,
        run,
        load,  ///< use the cached result of a former run or an earlier pass
    };
    /// How a gathering node consumes a frame.
    enum class Consume : char {
        none,
        inputs,  ///< from its inputs
        digest,  ///< from a cached digest
    };
    /// One frame in one pass. Both vectors are per node.
    struct Frame {
        std::vector<Action> results;    ///< of nodes that deliver per frame
        std::vector<Consume> consumes;  ///< of nodes that gather in this pass

        /// Whether the node reads its inputs in this frame.
        bool reads(std::size_t node) const {
            return results[node] == Action::run || consumes[node] == Consume::inputs;
        }
        /// Whether a node computes something, instead of only loading cached results.
        bool computes() const;
        /// Whether no node does anything.
        bool empty() const;
    };
    std::vector<std::vector<Frame>> frames;  ///< `[pass][t]`
    std::vector<Action> once;   ///< per node: for the result of a node that delivers once
    std::vector<char> gathers;  ///< per node: whether it consumes all its frames and finishes
};

/// Decides what each node does in each frame.
/// @param delivered  per frame: whether the frame is delivered
Schedule make_schedule(const Pipeline& pipeline, const Plan& plan,
                       const std::vector<bool>& delivered, const ScheduleQueries& known);

/// How often a node works, over all passes.
struct NodeWork {
    std::size_t frames = 0;  ///< frames that it computes
    std::size_t runs = 0;    ///< the same, but one that two passes compute counts twice
    /// For a gathering node: frames consumed from its inputs, and from cached digests.
    std::size_t consumed_inputs = 0, consumed_digests = 0;
    std::size_t loaded_results = 0;
    bool once = false;  ///< it finishes, or runs once

    std::size_t gathered() const { return consumed_inputs + consumed_digests; }
    /// Results and digests that are loaded from the cache.
    std::size_t loads() const { return loaded_results + consumed_digests; }
};
/// @return one entry per node
std::vector<NodeWork> work_of(const Schedule& schedule);

/// Indices of the frames in which a node works, over all passes.
struct NodeFrames {
    std::set<std::size_t> run;               ///< it computes the frame's result
    std::set<std::size_t> consumed_inputs;   ///< it consumes the frame from its inputs
    std::set<std::size_t> consumed_digests;  ///< it consumes the frame from a cached digest
};
NodeFrames working_frames(const Schedule& schedule, std::size_t node);

/// How much of a node's work a run needs and does. All counts are frames.
struct NodeDemand {
    /// Frames that the run needs; for a node that runs once: 1, or the frames that it gathers.
    std::size_t needed = 0;
    std::size_t computed = 0;  ///< of these, frames that the run computes; the others are cached
    /// Only the digests of a gathering node are wanted; `needed` and `computed` then count these.
    bool only_digests = false;
    /// For a gathering node: frames consumed from its inputs, and from cached digests.
    std::size_t consumed_inputs = 0, consumed_digests = 0;

    std::size_t gathered() const { return consumed_inputs + consumed_digests; }
};

/// @param uncached  the schedule of the same plan with an empty cache
/// @return one demand per node
std::vector<NodeDemand> demands_of(const Pipeline& pipeline, const Plan& plan,
                                   const Schedule& schedule, const Schedule& uncached);

}  // namespace fluidcarve
