#pragma once

#include "runtime/keep/dependencies.h"
#include "runtime/keep/grown_result.h"
#include "runtime/plan/schedule.h"
#include "runtime/tell/costs.h"

#include <nlohmann/json.hpp>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// The state of each node of a pipeline at its last run in a work folder, and how long it took.
/// With it a forecast can tell what changed since, and how long a run will take. One small file per
/// pipeline, named after the pipeline's file.
class History {
public:
    /// Reads the history; an unreadable file counts as empty.
    /// @param folder  the work folder; empty: no history
    History(const std::string& folder, const std::string& pipeline);

    bool on() const { return !path_.empty(); }
    /// The last state of a node: {"type", "version", "params", "rest"?, "inputs", "files",
    /// "plugin"?, "costs"?}; null if unknown.
    const nlohmann::json& state(const std::string& node) const;
    /// The present state of a node, in the form of `state` but without cost.
    /// @param reads  per frame of the sequence: whether the run reads the node's files
    static nlohmann::json made_of(const Pipeline& pipeline, std::size_t node,
                                  const Dependencies& dependencies, const std::vector<bool>& reads);

    /// Replaces the state of a node. Its cost is kept, and so are the files of frames that are not
    /// in `made_of`.
    void set(const std::string& node, nlohmann::json made_of);
    /// Replaces those costs that are known.
    /// @param input_bytes  CostSetting::input_bytes of all of them
    void set_cost(const std::string& node, const NodeCost& cost, std::uint64_t input_bytes);
    /// The measured costs of a node of this type.
    NodeCost cost(const std::string& node, const std::string& type) const;
    /// Writes the file. Ignores errors.
    void save() const;

private:
    std::string path_;
    bool foreign_ = false;  ///< the file at the path may be foreign: it is never replaced
    nlohmann::json nodes_;
};

/// What a forecast knows of a node before the run.
struct NodeNow {
    std::vector<bool> reads;           ///< per frame: whether the run reads the node's files
    std::optional<GrownResult> grown;  ///< how much of its growing result is kept
};

/// Why each node runs, in words; empty for nodes that do not run. What changed is listed in the
/// order of the pipeline: first the nodes upstream, then the node itself. A count is named only if
/// the node runs because of it: kept results answer smaller counts.
/// @return one text per node
std::vector<std::string> reasons(const Pipeline& pipeline, const std::vector<NodeDemand>& demands,
                                 const History& history, const Dependencies& dependencies,
                                 const std::function<NodeNow(std::size_t node)>& now);

}  // namespace fluidcarve
