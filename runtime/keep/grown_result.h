#pragma once

#include "graph/pipeline.h"
#include "runtime/keep/node_log.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <optional>

namespace fluidcarve {

/// What a growing result holds (Growth), as the header of a cached one states it.
struct GrownResult {
    ItemCount items;
    std::uint64_t bytes = 0;  ///< size in memory
    bool part = false;        ///< its node was still working on it
    bool exhausted = false;   ///< there are no more items (Growth::exhausted)

    /// Reads a header; nothing if the entry holds no growing result.
    static std::optional<GrownResult> in(const nlohmann::ordered_json& header);
    /// Adds {"size", "extent": {"count", "of"}, "part"?, "exhausted"?} to a header.
    void describe(nlohmann::ordered_json& header) const;

    /// Whether it holds all that the node wants, or all that exists if that is enough
    /// (Growth::best_effort).
    bool enough_for(const Node& node) const;
    /// Whether it is complete and holds exactly what the node wants, so that its report entry and
    /// its warnings mention no more.
    bool fits(const Node& node) const;
    /// Whether it holds at least as much as another result.
    bool holds(const GrownResult& other) const;
};

/// Whether the node takes fewer items than it wants, if there are no more (Growth::best_effort).
bool takes_fewer(const Node& node);

/// Cuts a growing result, its report entry and its warnings to what the node wants.
/// @param all  what the result holds; must be enough
void cut(const Node& node, const GrownResult& all, Payload& result, NodeLog& log);

/// The report entry of a growing result, from which its node continues; an empty object if there
/// is none. Such a node reports to one section at most.
nlohmann::ordered_json grown_entry(const NodeLog& log);

}  // namespace fluidcarve
