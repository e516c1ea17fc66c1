#pragma once

#include "graph/pipeline.h"

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// The part of a pipeline that the user wants to run.
struct Wish {
    std::string to;     ///< NODE: this node and everything upstream; NODE.INPUT: only the digests of a gatherer; empty: all leaves
    std::string from;   ///< only leaves downstream of this node; empty: all
    bool only = false;  ///< run `to` alone: cached nodes that it needs must already have their results
};

/// One pass of the frames through a part of the pipeline. All numbers are indices of pipeline nodes.
struct Pass {
    std::vector<std::size_t> before;     ///< nodes that run once before the frames, in order
    std::vector<std::size_t> per_frame;  ///< nodes that run per frame, in order
    std::vector<std::size_t> gatherers;  ///< nodes that take the frames in order and finish after the last
    std::vector<std::size_t> delivers;   ///< targets among `per_frame`: they run for the delivered frames

    /// `[gatherer][pipeline node]`: whether the gatherer needs the per-frame node.
    std::vector<std::vector<bool>> gatherer_needs;
};

/// The order of a run: the pipeline is cut into passes at its gathering nodes. The pass of a node is the largest number of gathering
/// nodes on a path to it. A per-frame node that a later pass needs again runs again, unless its results are cached.
struct Plan {
    std::vector<Pass> passes;
    std::vector<std::size_t> after;        ///< nodes that run once after the last pass
    std::vector<bool> targets;             ///< per node: whether the wish asks for it
    std::optional<std::size_t> digested;   ///< a gatherer of which only the digests are wanted
    std::vector<bool> needed;              ///< per node: whether it is a target or upstream of one
    std::vector<std::size_t> gathered_in;  ///< per node: the pass in which it gathers, if it does
};

/// What is wrong with a wish, in words; empty: nothing.
std::string fault_of(const Wish& wish, const Pipeline& pipeline);

/// Plans the passes of a run. @param wish  must have no fault
Plan make_plan(const Pipeline& pipeline, const Wish& wish);

/// What make_schedule asks about the cache and the nodes. A place is an index in the sequence; 0 for nodes that deliver once.
struct Known {
    std::function<bool(std::size_t node, std::size_t place)> result;  ///< whether the result is cached
    std::function<bool(std::size_t node, std::size_t place)> taken;   ///< whether a gatherer's digest of the frame is cached
    std::function<bool(std::size_t node, std::size_t place)> wants;   ///< whether a gatherer takes the frame
    std::function<bool(std::size_t node, std::size_t place)> keeps;   ///< whether later passes can load a result that this run computes
};

/// What each node will do in each frame of a run.
struct Schedule {
    enum class Action : char {
        none,
        run,
        load,  ///< use the cached result of a former run or an earlier pass
    };
    /// `[pass][place][node]`. For a gatherer in its pass: how it takes the frame, from its inputs (run) or from a cached digest (load).
    std::vector<std::vector<std::vector<Action>>> frames;
    std::vector<Action> once;   ///< per node: action for the result of a node that delivers once
    std::vector<char> gathers;  ///< per node: whether it takes all its frames and finishes
};

/// Decides what each node does in each frame. @param delivered  per place: whether the frame is delivered
Schedule make_schedule(const Pipeline& pipeline, const Plan& plan, const std::vector<bool>& delivered, const Known& known);

/// How much of a node's work a run does. All counts are frames.
struct Share {
    std::size_t frames = 0;                      ///< frames that the run needs; for a node that runs once: 1, or the frames that it gathers
    std::size_t runs = 0;                        ///< frames that the run computes; the others are cached
    bool only_takes = false;                     ///< only the digests of a gatherer are wanted; `frames` and `runs` then count these
    std::size_t taken_anew = 0, taken_kept = 0;  ///< for a gatherer: frames taken from its inputs, and from cached digests
};

/// @param nothing_kept  the schedule of the same plan with an empty cache
/// @return one share per node
std::vector<Share> shares(const Pipeline& pipeline, const Plan& plan, const Schedule& schedule, const Schedule& nothing_kept);

}  // namespace fluidcarve
