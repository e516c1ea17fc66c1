#pragma once

#include "graph/views/value_sources.h"
#include "runtime/flow/options.h"
#include "runtime/plan/plan.h"
#include "runtime/run/task.h"
#include "runtime/tell/progress.h"

#include <optional>
#include <string>

namespace fluidcarve {

/// A run as asked for on the command line.
struct RunRequest {
    RunOptions options{};
    RunTarget target{};           ///< the part of the pipeline to run
    std::string report_path{};    ///< empty: no report
    std::string html_path{};      ///< empty: no page
    std::string profile_path{};   ///< empty: no trace
    std::string manifest_path{};  ///< empty: no manifest
    ValueSources sources{};       ///< sources of the pipeline's values, for the page
    ProgressStyle progress = ProgressStyle::none;
    /// Seconds to wait for results of other runs in the work folder, which this run then does not
    /// make; nothing: it makes them.
    std::optional<double> wait{};
    /// The run is a task of this step of a farm's job, and is recorded as one; nothing: it is not.
    std::optional<JobStep> task{};
    bool quiet = false;  ///< print failures only
    /// Print the forecast before the run, and the time of each node after it.
    bool verbose = false;
};

}  // namespace fluidcarve
