#pragma once

#include "graph/pipeline.h"
#include "graph/views/value_sources.h"
#include "runtime/run/flow.h"
#include "runtime/tell/exit_codes.h"

#include <functional>
#include <optional>
#include <string>

namespace fluidcarve {

/// A run as asked for on the command line.
struct RunRequest {
    RunOptions options;
    std::optional<FrameSet> deliver;  ///< `-f`: frames that per-frame nodes deliver; nothing: all
    Wish wish;                        ///< the part of the pipeline to run
    std::string report_path;          ///< empty: no report
    std::string html_path;            ///< empty: no page
    std::string profile_path;         ///< empty: no trace
    std::string manifest_path;        ///< empty: no manifest
    ValueSources sources;             ///< sources of the pipeline's values, for the page
    ProgressStyle progress = ProgressStyle::none;
    bool quiet = false;    ///< print failures only
    bool verbose = false;  ///< print the forecast before the run, and the time of each node after it
};

/// The verb `plan`: prints the forecast of a run to stdout. Of input files it reads the headers, and hashes the content.
/// @return an exit code
int plan_pipeline(const Pipeline& pipeline, const Registry& registry, const RunRequest& request, bool json);

/// The verb `run`: runs a checked pipeline. Looks at the inputs, makes plan, schedule and forecast, executes, reports. Prints to stderr.
/// @param cancelled  called often; true: stop soon
/// @return an exit code
int run_pipeline(const Pipeline& pipeline, const Registry& registry, const RunRequest& request, const std::function<bool()>& cancelled);

}  // namespace fluidcarve
