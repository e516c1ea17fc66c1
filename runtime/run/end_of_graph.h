#pragma once

#include <tbb/flow_graph.h>

namespace fluidcarve {

/// Ends what still runs in a graph when a scope is left, by an exception, too. To be declared
/// behind the graph's nodes, which go before the graph does.
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
