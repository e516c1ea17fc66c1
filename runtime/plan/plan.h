#pragma once

#include "carve/base/frame_set.h"
#include "graph/pipeline.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// The part of a pipeline that the user wants to run.
struct RunTarget {
    std::string to;  ///< NODE: this node and everything upstream; NODE.INPUT: only the digests of a
                     ///< gathering node; several by commas; empty: all leaves
    std::string from = {};  ///< only leaves downstream of this node; empty: all
    /// Run `to` alone: cached nodes that it needs must already have their results.
    bool only = false;
    std::optional<FrameSet> frames = {};  ///< that per-frame nodes deliver; nothing: all
};

/// One pass of the frames through a part of the pipeline. All numbers are indices of pipeline
/// nodes.
struct Pass {
    std::vector<std::size_t> before;     ///< nodes that run once before the frames, in order
    std::vector<std::size_t> per_frame;  ///< nodes that run per frame, in order
    /// Nodes that consume the frames in order and finish after the last.
    std::vector<std::size_t> gathering;
    /// Targets among `per_frame`: they run for the delivered frames.
    std::vector<std::size_t> delivers;

    /// `[gathering node][pipeline node]`: whether the gathering node needs the per-frame node.
    std::vector<std::vector<bool>> gathering_needs;
};

/// The order of a run: the pipeline is cut into passes at its gathering nodes. The pass of a node
/// is the largest number of gathering nodes on a path to it. A per-frame node that a later pass
/// needs again runs again, unless its results are cached.
struct Plan {
    std::vector<Pass> passes;
    std::vector<std::size_t> after;  ///< nodes that run once after the last pass
    std::vector<bool> targets;       ///< per node: whether the run is for it
    /// Per node: whether it is a gathering node of which only the digests are wanted.
    std::vector<bool> digested;
    std::vector<bool> needed;  ///< per node: whether it is a target or upstream of one
    /// Per node: whether a gathering node needs it, and so in every frame, not only in delivered
    /// ones.
    std::vector<bool> in_sequence;
    std::vector<std::size_t> gathered_in;  ///< per node: the pass in which it gathers, if it does
};

/// Whether a node consumes frames as digests that later runs find in the work folder, so that many
/// runs can make them, each of its own frames.
bool digests_apart(const Node& node);
/// Whether a node makes one result of all frames, and later runs find it in the work folder, since
/// it takes long: a solver, for example.
bool gathers_apart(const Node& node);

/// What is wrong with a target, in words; empty: nothing.
std::string fault_of(const RunTarget& wanted, const Pipeline& pipeline);

/// Plans the passes of a run. @param wanted  must have no fault
Plan make_plan(const Pipeline& pipeline, const RunTarget& wanted);

}  // namespace fluidcarve
