#pragma once

#include "graph/pipeline.h"
#include "runtime/plan/plan.h"

#include <nlohmann/json.hpp>

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace fluidcarve {

/// A frame's (or a once-run node's) failure, as the user reads it.
struct Fault {
    std::string node;
    std::string type;
    std::optional<int> frame;
    std::string message;
    Failure::Kind kind = Failure::Kind::data;
};
/// "spin (energy.vorticity), frame 43: message"
std::string to_text(const Fault& fault);

/// How long a node takes, as far as it was measured, and what its result holds.
struct NodeCost {
    std::optional<double> frame_s;  ///< to compute one frame
    std::optional<double> take_s;   ///< of a gatherer: to take one from its inputs
    std::optional<double> once_s;   ///< to finish, or to run once
    std::uint64_t bytes = 0;
};

/// What happened in a run. All members may be called from several threads at once.
class Report {
public:
    explicit Report(const Pipeline& pipeline);

    /// What the run is to do of each node; said once, before it starts.
    void expect(std::vector<Share> shares);
    /// A node computed the result of one frame. @param bytes  held by it
    void ran(std::size_t node, std::size_t place, double seconds, std::uint64_t bytes);
    /// A gatherer took one frame from its inputs.
    void took(std::size_t node, std::size_t place, double seconds, std::uint64_t bytes);
    /// A node that runs once, or a gatherer, is done.
    void finished(std::size_t node, double seconds, std::uint64_t bytes);
    /// A result came from the work folder.
    void holds(std::size_t node, std::uint64_t bytes);
    void failed(Fault fault);
    void warn(std::size_t node, const std::string& message);
    /// @param entry  fields of the node's; a node that reports per frame adds fields
    void entry(std::size_t node, const std::string& section, nlohmann::ordered_json entry);

    const std::string& name(std::size_t node) const { return pipeline_.nodes[node].name; }
    /// As far as this run measured it.
    NodeCost cost(std::size_t node) const;
    /// How many frames of each node are done: there, or computed.
    std::vector<std::size_t> done() const;

    std::vector<Fault> faults() const;  ///< ordered by frame, then by the pipeline's order of nodes
    std::vector<std::string> warnings() const;
    /// The report file's content (the contract's "Report").
    nlohmann::ordered_json to_json(const std::vector<int>& delivered, int exit_code) const;

private:
    struct Stats {
        std::set<std::size_t> places;  ///< of the frames computed
        std::set<std::size_t> taken;   ///< places of the frames that it took from its inputs
        bool finished = false;
        double frame_s = 0, take_s = 0, once_s = 0;  ///< sums
        std::size_t runs = 0;
        std::uint64_t most_bytes = 0;
        double seconds() const { return frame_s + take_s + once_s; }
    };
    const Pipeline& pipeline_;
    const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    mutable std::mutex mutex_;
    /// How many of a node's frames this run computed.
    std::size_t computed(std::size_t node) const;

    std::vector<Stats> stats_;
    std::vector<Share> shares_;
    std::vector<Fault> faults_;
    std::set<std::pair<std::size_t, std::string>> warnings_;
    std::map<std::string, std::map<std::string, nlohmann::ordered_json>> entries_;
};

}  // namespace fluidcarve
