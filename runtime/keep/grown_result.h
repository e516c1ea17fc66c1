#pragma once

#include "graph/pipeline.h"
#include "runtime/keep/said.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <optional>

namespace fluidcarve {

/// How much of a growing result (Growth) there is. The header of a cached one says it.
struct GrownResult {
    Extent extent;
    std::uint64_t bytes = 0;  ///< size in memory
    bool part = false;        ///< its node was still working on it

    /// What a header says; nothing if the entry holds no growing result.
    static std::optional<GrownResult> in(const nlohmann::ordered_json& header);
    /// Adds {"size", "extent": {"count", "of"}, "part"?} to a header.
    void describe(nlohmann::ordered_json& header) const;

    /// Whether it holds all that the node wants.
    bool enough_for(const Node& node) const;
    /// Whether it is complete and holds exactly what the node wants.
    bool fits(const Node& node) const;
    /// Whether nothing is gained if the other result takes its place.
    bool holds(const GrownResult& other) const;
};

/// Cuts a growing result, its report entry and its warnings to what the node wants. @param all  how much the result holds; enough
void cut(const Node& node, const GrownResult& all, Payload& result, Said& said);

/// The report entry of a growing result, with which its node goes on; an empty object if there is none. Such a node reports to one
/// section at most.
nlohmann::ordered_json grown_entry(const Said& said);

}  // namespace fluidcarve
