#pragma once

#include "graph/pipeline.h"

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// Which part of a pipeline is asked for.
struct Wish {
    std::string to;     ///< this node and what it needs, or NODE.INPUT: what a gatherer takes of each frame; empty: all leaves
    std::string from;   ///< only what this node leads to; empty: everything
    bool only = false;  ///< what `to` needs must be there: nothing else that is worth keeping is computed
};

/// One streaming of the frames through a part of the pipeline.
struct Pass {
    std::vector<std::size_t> before;     ///< nodes that run once, before the frames, in order
    std::vector<std::size_t> per_frame;  ///< nodes that run frame by frame, in order
    std::vector<std::size_t> gatherers;  ///< nodes that take the frames in order, and finish after the last
    std::vector<std::size_t> delivers;   ///< of `per_frame`: those asked for themselves, for the delivered frames only

    /// Per gatherer, as flags over the pipeline's nodes: the per-frame nodes that it needs.
    std::vector<std::vector<bool>> gatherer_needs;
};

/// The order of a run: the pipeline cut at its gathering nodes. A node's pass is its depth in gathering nodes; what a
/// later pass needs of an earlier one's per-frame nodes runs again, unless it is kept.
struct Plan {
    std::vector<Pass> passes;
    std::vector<std::size_t> after;        ///< nodes that run once after the last pass
    std::vector<bool> targets;             ///< as flags: the nodes that were asked for
    std::optional<std::size_t> digested;   ///< a gatherer that is to take its frames, and no more
    std::vector<bool> needed;              ///< as flags: the targets and all that they need
    std::vector<std::size_t> gathered_in;  ///< per node that gathers: the pass
};

/// What is wrong with a wish, in words; empty if nothing is.
std::string fault_of(const Wish& wish, const Pipeline& pipeline);

/// @param wish  without fault
Plan make_plan(const Pipeline& pipeline, const Wish& wish);

/// What there is of former runs.
struct Known {
    std::function<bool(std::size_t node, std::size_t place)> result;  ///< for any other than per-frame nodes the place is 0
    std::function<bool(std::size_t node, std::size_t place)> taken;   ///< a gatherer's digest of a frame
    std::function<bool(std::size_t node, std::size_t place)> wants;   ///< whether a gatherer takes the frame
    std::function<bool(std::size_t node, std::size_t place)> keeps;   ///< what a pass computes of a kept result, later ones find
};

/// What a run does: each node, each frame, before it starts.
struct Schedule {
    enum class Action : char {
        none,
        run,
        load,  ///< what a former run, or an earlier pass, kept
    };
    /// Per pass, place and node. Of gatherers: whether they take the frame, from its inputs or as it was kept.
    std::vector<std::vector<std::vector<Action>>> frames;
    std::vector<Action> once;   ///< per node that delivers once: its result
    std::vector<char> gathers;  ///< per node: it takes its frames, all of them, and finishes
};

/// @param delivered  per place in the sequence
Schedule make_schedule(const Pipeline& pipeline, const Plan& plan, const std::vector<bool>& delivered, const Known& known);

/// How much of a node a run does.
struct Share {
    std::size_t frames = 0;                      ///< that it is about; of a node that runs once: 1, or as many as it gathers
    std::size_t runs = 0;                        ///< of those, which are computed; all others are there already
    bool only_takes = false;                     ///< it is about what a gatherer takes
    std::size_t taken_anew = 0, taken_kept = 0;  ///< of a gatherer: frames that it takes from its inputs, and as they were kept
};

/// @param nothing_kept  the schedule of the same plan if nothing were known
/// @return per node
std::vector<Share> shares(const Pipeline& pipeline, const Plan& plan, const Schedule& schedule, const Schedule& nothing_kept);

}  // namespace fluidcarve
