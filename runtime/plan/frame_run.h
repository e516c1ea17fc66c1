#pragma once

#include "graph/pipeline.h"
#include "runtime/plan/schedule.h"

#include <atomic>
#include <cstddef>
#include <vector>

namespace fluidcarve {

/// The state of one frame during a pass. A node of the pass runs when its last input has arrived.
/// Vectors are per pipeline node.
struct FrameRun {
    FrameRun(std::size_t t, std::size_t order, const Schedule::Frame& scheduled)
        : t(t),
          order(order),
          scheduled(scheduled),
          outputs(scheduled.results.size()),
          waiting(outputs.size()),
          readers(outputs.size()),
          failed(outputs.size()) {}

    const std::size_t t;                        ///< index in the sequence
    const std::size_t order;                    ///< order of admission: 0, 1, 2, ...
    const Schedule::Frame& scheduled;           ///< what the nodes do in this frame
    std::vector<std::vector<Payload>> outputs;  ///< `[node][output]`
    std::vector<std::atomic<int>> waiting;      ///< number of sources that have not delivered yet
    std::vector<std::atomic<int>> readers;  ///< number of nodes that have yet to read the outputs
    std::vector<char> failed;               ///< whether the node failed in this frame
    std::atomic<int> open{0};  ///< number of end nodes that have not finished this frame
};

/// The edges between the nodes of one pass. All numbers are indices of pipeline nodes.
struct Wiring {
    std::vector<std::size_t> units;  ///< nodes of the pass: per-frame nodes, then gathering ones
    /// Per pipeline node: per-frame nodes that it reads, each once.
    std::vector<std::vector<std::size_t>> sources;
    std::vector<std::vector<std::size_t>> readers;  ///< per pipeline node: units that read it

    /// Whether a node that this one reads failed in a frame.
    bool failed_before(std::size_t node, const FrameRun& frame) const;
    /// Frees outputs of which this node was the last reader, before the end of the frame.
    void release(std::size_t node, FrameRun& frame) const;
};

Wiring wire(const Pipeline& pipeline, const Pass& pass);

}  // namespace fluidcarve
