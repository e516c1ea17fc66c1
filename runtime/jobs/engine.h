#pragma once

#include "runtime/jobs/job.h"

#include <functional>
#include <string>
#include <vector>

namespace fluidcarve {

/// What the command line asks of an engine.
struct FarmRequest {
    bool submit = false;  ///< hand the job to the scheduler
    std::string output;  ///< folder for what the engine writes; empty: one of the job's name in the
                         ///< current folder
    int processes = 1;   ///< of the local engine: tasks at once
    bool chunk_ranges = true;  ///< of OpenJD: chunks by the extension TASK_CHUNKING; false: pairs
                               ///< of first and last frame
    bool quiet = false;        ///< print failures only
    std::function<bool()> cancelled = [] {
        return false;
    };  ///< to be asked often; true: end what was started, soon
};

/// What runs the steps of a job, or writes them in the form that a scheduler takes.
struct FarmEngine {
    std::string name;
    std::string doc;              ///< one clause, for the help
    std::string progress;         ///< how tasks show progress (`run --progress`)
    bool other_machines = false;  ///< tasks run elsewhere, so that the work folder must be shared
    /// Those of the verb that only some engines take, and this one does.
    std::vector<std::string> options;
    /// Why it can't do what is asked; empty: it can. Left out: it always can.
    std::function<std::string(const FarmRequest& request)> refusal;
    /// Prints what it did. The job is in the work folder by then.
    /// @return an exit code
    /// @throws Failure
    std::function<int(const FarmJob& job, const FarmRequest& request)> farm;
};

}  // namespace fluidcarve
