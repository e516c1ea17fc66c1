#pragma once

#include "graph/pipeline.h"
#include "runtime/plan/plan.h"

#include <atomic>
#include <cstddef>
#include <memory>
#include <vector>

namespace fluidcarve {

/// One frame on its way through a pass. Nodes of the pass fire when their last input has arrived.
struct FrameRun {
    FrameRun(std::size_t place, std::size_t order, std::size_t nodes)
        : place(place), order(order), outputs(nodes), waiting(nodes), readers(nodes), failed(nodes) {}

    const std::size_t place;  ///< in the sequence
    const std::size_t order;  ///< of admission, without gaps
    std::vector<std::vector<Payload>> outputs;
    std::vector<std::atomic<int>> waiting;  ///< inputs still to arrive
    std::vector<std::atomic<int>> readers;  ///< nodes that have yet to read the outputs
    std::vector<Schedule::Action> actions;  ///< what each node does in this frame
    std::vector<char> failed;
    std::atomic<int> open{0};  ///< ends of the graph not yet reached
};
/// The edges of one pass, between pipeline nodes.
struct Wiring {
    std::vector<std::size_t> units;                 ///< per-frame nodes, then gatherers
    std::vector<std::vector<std::size_t>> sources;  ///< per pipeline node: units that it reads
    std::vector<std::vector<std::size_t>> readers;  ///< per pipeline node: units that read it
};

Wiring wire(const Pipeline& pipeline, const Pass& pass);

}  // namespace fluidcarve
