#pragma once

#include "runtime/keep/dependencies.h"
#include "runtime/tell/report.h"

#include <nlohmann/json.hpp>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// The state of each node of a pipeline at its last run in a work folder, and how long it took. With it a forecast can tell what
/// changed since, and how long a run will take. One small file per pipeline, named after the pipeline's file.
class History {
public:
    /// Reads the history; an unreadable file counts as empty. @param folder  the work folder; empty: no history
    History(const std::string& folder, const std::string& pipeline);

    bool on() const { return !path_.empty(); }
    /// The last state of a node: {"type", "version", "params", "inputs", "files", "plugin"?, "cost"?}; null if unknown.
    const nlohmann::json& of(const std::string& node) const;
    /// The present state of a node, in the form of `of` but without cost.
    /// @param reads  per place in the sequence: whether the run reads the node's files
    static nlohmann::json made_of(const Pipeline& pipeline, std::size_t node, const Dependencies& dependencies, const std::vector<bool>& reads);

    /// Replaces the state of a node. Its cost is kept, and so are the files of frames that are not in `made_of`.
    void set(const std::string& node, nlohmann::json made_of);
    void set_cost(const std::string& node, const NodeCost& cost, std::uint64_t input_bytes);
    /// The measured cost of a node, scaled to inputs of this size. @param input_bytes  bytes of a frame; 0: unknown, not scaled
    std::optional<NodeCost> cost(const std::string& node, std::uint64_t input_bytes) const;
    /// Writes the file. Ignores errors.
    void save() const;

private:
    std::string path_;
    bool foreign_ = false;  ///< the file at the path may be somebody else's: it is never replaced
    nlohmann::json nodes_;
};

/// Why each node runs, in words; empty for nodes that do not run.
/// @param reads  per node and place: whether the run reads the node's files
/// @return one text per node
std::vector<std::string> reasons(const Pipeline& pipeline, const std::vector<Share>& shares, const History& history, const Dependencies& dependencies,
                                 const std::function<std::vector<bool>(std::size_t node)>& reads);

}  // namespace fluidcarve
