#pragma once

#include "graph/pipeline.h"

#include <cstddef>
#include <string>
#include <vector>

namespace fluidcarve {

/// One streaming of the frames through a part of the pipeline.
struct Pass {
    std::vector<std::size_t> before;     ///< nodes that run once, before the frames, in order
    std::vector<std::size_t> per_frame;  ///< nodes that run frame by frame, in order
    std::vector<std::size_t> gatherers;  ///< nodes that take the frames in order, and finish after the last
    std::vector<std::size_t> delivers;   ///< of `per_frame`: those asked for themselves, for the delivered frames only

    /// Per gatherer, as flags over the pipeline's nodes: the per-frame nodes that it needs.
    std::vector<std::vector<bool>> gatherer_needs;
    /// As flags: the per-frame nodes that delivery needs, the delivering ones included.
    std::vector<bool> delivery_needs;
};

/// The order of a run: the pipeline cut at its gathering nodes. A node's pass is its depth in gathering nodes; what a
/// later pass needs of an earlier one's per-frame nodes runs again.
struct Plan {
    std::vector<Pass> passes;
    std::vector<std::size_t> after;  ///< nodes that run once after the last pass
    std::vector<bool> targets;       ///< as flags: the nodes that were asked for
};

/// @param to  only this node and what it needs; empty: all leaves of the pipeline
Plan make_plan(const Pipeline& pipeline, const std::string& to);

/// The plan in words, for `fluidcarve plan`.
/// @param delivered  how many frames per-frame nodes deliver
std::string to_text(const Plan& plan, const Pipeline& pipeline, std::size_t delivered);

}  // namespace fluidcarve
