#pragma once

#include "runtime/keep/history.h"
#include "runtime/run/preparation.h"

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// What a run will do, node by node, why, and what it will take.
struct Forecast {
    struct Line {
        std::string node, type;
        std::size_t frames = 0;                   ///< that the node is about
        std::size_t cached = 0;                   ///< of those, what is there already
        std::string why;                          ///< the others are not; empty if there are none
        std::size_t taken = 0, taken_cached = 0;  ///< of a gatherer: frames that it takes
    };
    struct Stream {
        std::size_t frames = 0;
        std::vector<std::string> nodes, gatherers;
    };
    std::string pipeline;
    FrameSet frames, delivered;
    std::vector<Line> lines;      ///< of the nodes that are needed
    std::vector<Stream> streams;  ///< the passes in which something is computed
    double seconds = 0;           ///< as far as nodes were measured
    std::vector<std::string> unmeasured;
    std::uint64_t bytes = 0;  ///< memory; 0: nobody knows
};

Forecast forecast(const Pipeline& pipeline, const Preparation& prepared, const Schedule& schedule, const std::vector<Share>& shares, const History& history,
                  Keys& keys, const RunOptions& options);

/// As a table, with times and memory.
std::string to_text(const Forecast& forecast);
/// {"pipeline", "frames", "nodes": {name: {"type", "frames", "cached", "why", "taken": {"frames", "cached"}}}, "passes", "seconds", "unmeasured", "bytes"}
nlohmann::ordered_json to_json(const Forecast& forecast);

/// A table's columns, the first two to the left, those of numbers to the right.
/// @param rows  the first is the head; all of equal size; the last column is text
std::string table(const std::vector<std::vector<std::string>>& rows);

}  // namespace fluidcarve
