#pragma once

#include <tbb/flow_graph.h>

namespace fluidcarve {

/// Cancels a graph and waits for its tasks when a scope is left, also by an exception. Declare it
/// after the graph's nodes, which are destroyed before the graph.
class EndOfGraph {
public:
    explicit EndOfGraph(tbb::flow::graph& graph) : graph_(graph) {}
    ~EndOfGraph() {
        graph_.cancel();
        graph_.wait_for_all();
    }
    EndOfGraph(const EndOfGraph&) = delete;
    EndOfGraph& operator=(const EndOfGraph&) = delete;

private:
    tbb::flow::graph& graph_;
};

}  // namespace fluidcarve
