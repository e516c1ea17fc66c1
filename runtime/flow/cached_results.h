#pragma once

#include "runtime/flow/body_host.h"

#include <atomic>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace fluidcarve {

/// Loads and keeps results of nodes in the store, and tells of it. Thread-safe for different nodes
/// and frames.
class CachedResults {
public:
    /// @param setup  must outlive it
    explicit CachedResults(const FlowSetup& setup) : setup_(setup) {}

    /// Outputs of a node in frame `t`. @return nothing if they are missing: they are lost
    std::optional<std::vector<Payload>> load(std::size_t n, std::size_t t);
    /// A gathering node's digest of frame `t`. @return nothing if it is missing: it is lost
    std::optional<Payload> load_digest(std::size_t n, std::size_t t);
    /// The part of a growing result that an earlier run made (Store::part).
    std::optional<std::pair<Payload, nlohmann::ordered_json>> load_part(std::size_t n);

    /// Keeps the outputs and the log of a body, if the node is cached.
    void keep(const BodyHost& host, std::size_t t, const std::vector<Payload>& outputs);
    void keep_digest(const BodyHost& host, std::size_t t, const Payload& digest);

    /// Whether all outputs of a node are kept.
    bool keeps(std::size_t n) const { return node(n).kept && setup_.options.cache; }
    /// Whether a cached result was missing (Flow::lost).
    bool lost() const { return lost_; }

private:
    const Node& node(std::size_t n) const { return setup_.pipeline.nodes[n]; }
    /// Number of frame `t`; nothing for a node that runs once.
    std::optional<int> frame_of(std::size_t n, std::size_t t) const;

    const FlowSetup& setup_;
    std::atomic<bool> lost_{false};
};

}  // namespace fluidcarve
