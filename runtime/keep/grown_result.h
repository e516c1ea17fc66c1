#pragma once

#include "graph/pipeline.h"
#include "runtime/keep/node_log.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <optional>

namespace fluidcarve {

/// How much of a growing result (Growth) there is. The header of a cached one says it.
struct GrownResult {
    Extent extent;
    std::uint64_t bytes = 0;  ///< size in memory
    bool part = false;        ///< its node was still working on it
    bool exhausted = false;   ///< there are no more items (Growth::exhausted)

    /// What a header says; nothing if the entry holds no growing result.
    static std::optional<GrownResult> in(const nlohmann::ordered_json& header);
    /// Adds {"size", "extent": {"count", "of"}, "part"?, "exhausted"?} to a header.
    void describe(nlohmann::ordered_json& header) const;

    /// Whether it holds all that the node wants, or all there is if that is enough
    /// (Growth::best_effort).
    bool enough_for(const Node& node) const;
    /// Whether it is complete and holds exactly what the node wants, so that neither its report
    /// entry nor its warnings speak of more.
    bool fits(const Node& node) const;
    /// Whether nothing is gained if the other result takes its place.
    bool holds(const GrownResult& other) const;
};

/// Whether the node takes fewer items than it wants, if there are no more (Growth::best_effort).
bool takes_fewer(const Node& node);

/// Cuts a growing result, its report entry and its warnings to what the node wants.
/// @param all  how much the result holds; enough
void cut(const Node& node, const GrownResult& all, Payload& result, NodeLog& log);

/// The report entry of a growing result, with which its node goes on; an empty object if there is
/// none. Such a node reports to one section at most.
nlohmann::ordered_json grown_entry(const NodeLog& log);

}  // namespace fluidcarve
