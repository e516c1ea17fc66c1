#pragma once

#include <nlohmann/json.hpp>

#include <map>
#include <string>
#include <vector>

namespace fluidcarve {

/// Warnings and report entries of a node body. They are cached with its result, and repeated when
/// the result is taken from the cache.
struct NodeLog {
    std::vector<std::string> warnings;
    std::map<std::string, nlohmann::ordered_json> report;  ///< by section
    bool empty() const { return warnings.empty() && report.empty(); }
};

/// {"warnings"?, "report"?}: the header of a cache entry begins so.
nlohmann::ordered_json to_json(const NodeLog& log);
/// The warnings and report entries in the header of a cache entry.
NodeLog log_in(const nlohmann::ordered_json& header);

}  // namespace fluidcarve
