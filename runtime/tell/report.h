#pragma once

#include "graph/pipeline.h"
#include "runtime/plan/schedule.h"

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

/// A failure of a node, in one frame or as a whole.
struct NodeFailure {
    std::string node;
    std::string type;
    std::optional<int> frame;
    std::string message;
    Failure::Kind kind = Failure::Kind::data;
};
/// A failure of a node. @param frame  nothing: of the node as a whole
inline NodeFailure failure_in(const Node& node, std::optional<int> frame, std::string message,
                              Failure::Kind kind) {
    return {node.name, node.type->name, frame, std::move(message), kind};
}
/// The failure as a line of text: "spin (energy.vorticity), frame 43: message".
std::string to_text(const NodeFailure& failure);

/// Progress of a node that gathers frames and has not finished.
struct GatheringProgress {
    std::size_t frames = 0, of_frames = 0;  ///< frames that it has consumed, and that it needs
    std::size_t items = 0, of_items = 0;    ///< kept items of its growing result (Growth), and the
                                            ///< wanted number; 0 of 0: unknown
};

/// Collects what happens in a run. Thread-safe.
class Report {
public:
    explicit Report(const Pipeline& pipeline);

    /// Sets how much of each node the run will do. Called once, before the run starts.
    /// @param demands  one per node
    void expect(std::vector<NodeDemand> demands);
    /// A node computed the result of one frame.
    /// @param t      index in the sequence
    /// @param bytes  size of the result in memory
    void ran(std::size_t node, std::size_t t, double seconds, std::uint64_t bytes);
    /// A gathering node has consumed one frame of its inputs.
    void consumed(std::size_t node, std::size_t t, double seconds, std::uint64_t bytes);
    /// A gathering node has consumed one frame, from its inputs or from a cached digest.
    void gathered(std::size_t node, std::size_t t);
    /// So many items of a growing result are kept. @param of  the wanted number of items
    void grew(std::size_t node, std::size_t items, std::size_t of);
    /// The body of a node that runs once, or of a gathering node, has ended.
    /// @param good  whether it has finished, and did not fail or stop early
    void ended(std::size_t node, double seconds, std::uint64_t bytes, bool good);
    /// A node's result was loaded from the cache.
    void holds(std::size_t node, std::uint64_t bytes);
    void failed(NodeFailure failure);
    /// @return the warning as a line of text; empty if it is known already
    std::string warn(std::size_t node, const std::string& message);
    /// Adds a node's entry to a section.
    /// @param entry  a JSON object; entries of the same node are merged
    void entry(std::size_t node, const std::string& section, nlohmann::ordered_json entry);
    /// Adds a line to show at the end of the run, behind the node's name.
    void add_line(std::size_t node, const std::string& line);

    const std::string& name(std::size_t node) const { return pipeline_.nodes[node].name; }
    std::uint64_t most_bytes(std::size_t node) const;  ///< largest result in memory; 0: unknown
    /// Per node: number of frames that are cached or already computed.
    std::vector<std::size_t> done() const;
    /// Progress of a node; nothing if it gathers nothing in this run, or has finished.
    std::optional<GatheringProgress> gathering(std::size_t node) const;

    /// Sorted by frame, then by the pipeline's order of nodes.
    std::vector<NodeFailure> failures() const;
    std::vector<std::string> warnings() const;
    /// Only for use when no node is at work.
    const std::vector<std::string>& lines() const { return lines_; }
    /// A node's entry in a section; null if there is none.
    nlohmann::ordered_json entry_of(std::size_t node, const std::string& section) const;
    /// The content of the report file (pipelines/FORMATS.md).
    /// @param delivered  numbers of the delivered frames
    nlohmann::ordered_json to_json(const std::vector<int>& delivered, int exit_code) const;

private:
    struct Stats {
        /// Indices of frames: computed; consumed from its inputs; from its inputs or from digests.
        std::set<std::size_t> computed, consumed, gathered;
        std::size_t items = 0, of_items = 0;
        bool finished = false;
        double frame_s = 0, consume_s = 0, once_s = 0;  ///< sums of seconds
        std::uint64_t most_bytes = 0;
        double seconds() const { return frame_s + consume_s + once_s; }
    };
    const Pipeline& pipeline_;
    const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    mutable std::mutex mutex_;
    /// Number of a node's frames that this run computed.
    std::size_t computed(std::size_t node) const;
    /// A warning as a line of text.
    std::string line_of(std::size_t node, const std::string& message) const;

    std::vector<Stats> stats_;
    std::vector<NodeDemand> demands_;
    std::vector<NodeFailure> failures_;
    std::set<std::pair<std::size_t, std::string>> warnings_;
    std::map<std::string, std::map<std::string, nlohmann::ordered_json>> entries_;
    std::vector<std::string> lines_;
};

}  // namespace fluidcarve
