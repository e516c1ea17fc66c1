#pragma once

#include "graph/pipeline.h"

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

/// What happened in a run. All members may be called from several threads at once.
class Report {
public:
    explicit Report(const Pipeline& pipeline);

    /// @param frames  1 for a run or an add of one frame, 0 for a finish
    /// @param bytes   held by what it delivered
    void ran(std::size_t node, std::size_t frames, double seconds, std::uint64_t bytes);
    void failed(Fault fault);
    void warn(std::size_t node, const std::string& message);
    /// @param entry  fields of the node's; a node that reports per frame adds fields
    void entry(std::size_t node, const std::string& section, nlohmann::ordered_json entry);

    std::vector<Fault> faults() const;  ///< ordered by frame, then by the pipeline's order of nodes
    std::vector<std::string> warnings() const;
    /// The report file's content (the contract's "Report").
    nlohmann::ordered_json to_json(const std::vector<int>& delivered, int exit_code) const;

private:
    struct Stats {
        bool ran = false;
        std::size_t frames = 0;
        double seconds = 0;
        std::uint64_t most_bytes = 0;
    };
    const Pipeline& pipeline_;
    const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    mutable std::mutex mutex_;
    std::vector<Stats> stats_;
    std::vector<Fault> faults_;
    std::set<std::pair<std::size_t, std::string>> warnings_;
    std::map<std::string, std::map<std::string, nlohmann::ordered_json>> entries_;
};

}  // namespace fluidcarve
