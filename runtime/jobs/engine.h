#pragma once

#include "runtime/jobs/job.h"

#include <functional>
#include <string>
#include <vector>

namespace fluidcarve {

/// What the command line asks of an engine.
struct FarmRequest {
    bool submit = false;  ///< hand the job to the scheduler
    std::string output;   ///< folder for the engine's files; empty: a folder named like the job in
                          ///< the current folder
    int processes = 1;    ///< of the local engine: tasks in parallel
    bool chunk_ranges = true;  ///< of OpenJD: chunks use the extension TASK_CHUNKING; false: they
                               ///< are pairs of first and last frame
    bool quiet = false;        ///< print failures only
    /// Called often; true: end all started tasks soon.
    std::function<bool()> cancelled = [] { return false; };
};

/// Runs the steps of a job, or writes them in the format of a scheduler.
struct FarmEngine {
    std::string name;
    std::string doc;              ///< one clause, for the help
    std::string progress;         ///< how tasks show progress (`run --progress`)
    bool other_machines = false;  ///< tasks run elsewhere, so that the work folder must be shared
    /// Options of the verb that this engine takes, but not every engine.
    std::vector<std::string> options;
    /// Why it can't fulfil a request; an empty text: it can; no function: it always can.
    std::function<std::string(const FarmRequest& request)> refusal;
    /// Prints what it did. The job is in the work folder by then.
    /// @return an exit code
    /// @throws Failure
    std::function<int(const FarmJob& job, const FarmRequest& request)> farm;
};

}  // namespace fluidcarve
