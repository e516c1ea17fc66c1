#pragma once

#include "carve/base/frame_set.h"
#include "runtime/keep/history.h"
#include "runtime/run/preparation.h"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace fluidcarve {

/// What a run will do, node by node and pass by pass, with its estimated time and memory. The verb
/// `plan` prints it.
struct Forecast {
    struct Line {
        std::string node, type;
        std::size_t frames = 0;  ///< frames that the run needs
        std::size_t cached = 0;  ///< frames whose results are cached
        std::string why;         ///< why the node runs; empty if it does not
        /// For a gathering node: frames that it consumes; of these, from cached digests.
        std::size_t gathered = 0, consumed_digests = 0;
        std::string item = {};  ///< what its growing result (Growth) holds; empty: it has none
    };
    struct Pass {
        std::size_t frames = 0;
        std::vector<std::string> nodes, gathering;
    };
    std::string pipeline;
    FrameSet frames, delivered;
    std::vector<Line> lines;   ///< the nodes that the run needs
    std::vector<Pass> passes;  ///< passes in which a node runs
    double seconds = 0;        ///< estimated wall time of the nodes that were measured before
    std::vector<std::string> unmeasured;  ///< nodes without a measured time
    bool remembers = true;                ///< whether there is a work folder, which stores
                                          ///< measured times
    /// Per node of the pipeline: its costs in the setting of this run.
    std::vector<NodeCost> expected;
    std::uint64_t bytes = 0;  ///< estimated memory; 0: unknown
    /// Estimated bytes that are written, to the work folder and to outputs; 0: unknown.
    std::uint64_t disk = 0;
    int cores = 0;  ///< threads
};

/// Estimated bytes of memory that a node takes in a run, or in a part of one.
/// @param cost  in the setting of the run
/// @param input_bytes  of a reader's frame; 0: unknown
std::uint64_t memory_of(const Node& node, const NodeCost& cost, const NodeWork& work,
                        std::uint64_t input_bytes, const RunOptions& options);
/// Estimated bytes that a node writes: its results in the work folder, or its files.
std::uint64_t disk_of(const Node& node, const NodeCost& cost, const NodeWork& work,
                      std::uint64_t input_bytes);

Forecast make_forecast(const Pipeline& pipeline, const Preparation& prepared,
                       const Schedule& schedule, const std::vector<NodeDemand>& demands,
                       const History& history, const RunOptions& options);

/// The forecast as a table, followed by time and memory.
std::string to_text(const Forecast& forecast);
/// The forecast for programs, as pipelines/FORMATS.md says, without steps.
nlohmann::ordered_json to_json(const Forecast& forecast);

}  // namespace fluidcarve
