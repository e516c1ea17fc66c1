#pragma once

#include "runtime/keep/keys.h"
#include "runtime/tell/report.h"

#include <nlohmann/json.hpp>

#include <map>
#include <optional>
#include <string>

namespace fluidcarve {

/// What the nodes of a pipeline were made of when they were last to run in a work folder, and how long they took: so that a plan can
/// say what changed, and how long it will take. One small file per pipeline, by the name of its file.
class History {
public:
    /// @param folder  the work folder; empty: there is no history. A file that can't be read is none.
    History(const std::string& folder, const std::string& pipeline);

    bool on() const { return !path_.empty(); }
    /// What is known of a node: {"type", "version", "params", "inputs", "files", "cost"}; null if nothing.
    const nlohmann::json& of(const std::string& node) const;
    /// @return what the node is made of now, as `of` gives it later
    /// @param reads  per place: whether the run looks at the node's files there
    static nlohmann::json made_of(const Pipeline& pipeline, std::size_t node, Keys& keys, const std::vector<int>& frames, const std::vector<bool>& reads);

    /// Sets a node's part; its cost stays, and what is known of files that were not looked at.
    void set(const std::string& node, nlohmann::json made_of);
    void set_cost(const std::string& node, const NodeCost& cost, std::uint64_t input_bytes);
    /// A node's cost, as far as it was measured, for inputs of this size. @param input_bytes  0: of unknown size
    std::optional<NodeCost> cost(const std::string& node, std::uint64_t input_bytes) const;
    /// Writes the file. What can't be written is forgotten.
    void save() const;

private:
    std::string path_;
    nlohmann::json nodes_;
};

/// Why each node runs, for people; empty for those that do not.
std::vector<std::string> reasons(const Pipeline& pipeline, const std::vector<Share>& shares, const History& history, Keys& keys, const std::vector<int>& frames,
                                 const std::function<std::vector<bool>(std::size_t node)>& reads);

}  // namespace fluidcarve
