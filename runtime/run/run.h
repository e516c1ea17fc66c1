#pragma once

#include "graph/pipeline.h"
#include "graph/views/origins.h"
#include "runtime/run/flow.h"

#include <functional>
#include <optional>
#include <string>

namespace fluidcarve {

/// The program's exit codes (the contract's list).
namespace exit_code {
constexpr int done = 0;
constexpr int node_failed = 1;
constexpr int usage = 2;
constexpr int input = 3;
constexpr int some_frames_failed = 4;
constexpr int interrupted = 130;
}  // namespace exit_code

struct RunRequest {
    RunOptions options;
    std::optional<FrameSet> deliver;  ///< `-f`: what per-frame nodes deliver; nothing: all
    Wish wish;                        ///< which part of the pipeline
    std::string report_path;          ///< empty: none is written
    std::string html_path;            ///< the same for the page
    std::string profile_path;         ///< and for the trace
    Origins origins;                  ///< of the pipeline's values, for the page
    ProgressStyle progress = ProgressStyle::none;
    bool quiet = false;    ///< only failures are told
    bool verbose = false;  ///< the plan before, the time of each node after
};

/// Says on stdout what a run would do, and why; opens no data beyond the heads of files, and what is in them.
/// @return an exit code
int plan_pipeline(const Pipeline& pipeline, const Registry& registry, const RunRequest& request, bool json);

/// Runs a checked pipeline to its end: looks at the inputs, plans, streams, reports. Everything is told on stderr.
/// @param cancelled  asked often; true: stop soon
/// @return an exit code
int run_pipeline(const Pipeline& pipeline, const Registry& registry, const RunRequest& request, const std::function<bool()>& cancelled);

}  // namespace fluidcarve
