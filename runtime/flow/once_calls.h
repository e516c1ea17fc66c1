#pragma once

#include "runtime/flow/body_calls.h"
#include "runtime/flow/cached_results.h"

#include <cstddef>
#include <set>
#include <vector>

namespace fluidcarve {

/// What nodes do once for all frames: `once` in nodes that run once, `finish` in nodes that have
/// gathered a pass. Their results are held until the last reader has run. Calls come from one
/// thread.
class OnceCalls {
public:
    /// All must outlive it.
    /// @param held  receives the results
    OnceCalls(const FlowSetup& setup, BodyCalls& bodies, CachedResults& results,
              PortIo::Outputs& held);

    /// Runs a node once.
    /// @param target  whether the run is for this node's outputs
    void once(std::size_t n, bool target);
    /// Finishes a node that has gathered all frames.
    /// @param gathered  how many it consumed
    void finish(std::size_t n, std::size_t gathered);
    /// The node can't finish: the frames `failed` are missing.
    void lacks_frames(std::size_t n, const std::vector<int>& failed);
    void load(std::size_t n);
    /// Frees what no other node will read, once a node has run.
    void release(std::size_t n);

private:
    const Node& node(std::size_t n) const { return setup_.pipeline.nodes[n]; }
    /// Calls `finish` of a node. If its result grows, it goes on from what is cached.
    void finish_from_cached(BodyHost& host, void* ports, Context& context);
    /// Tells the end of a body, and keeps what it holds. A failure ends the run.
    void end(BodyHost& host, bool good, bool delivers, std::size_t gathered);

    const FlowSetup& setup_;
    BodyCalls& bodies_;
    CachedResults& results_;
    PortIo::Outputs& held_;
    const PortIo io_;
    /// Per node: those that may still read what it holds.
    std::vector<std::set<std::size_t>> readers_;
};

}  // namespace fluidcarve
