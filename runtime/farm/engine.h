#pragma once

#include "runtime/farm/job.h"

#include <functional>
#include <string>
#include <vector>

namespace fluidcarve {

/// What the command line asks of an engine.
struct FarmRequest {
    bool submit = false;       ///< hand the job to the engine
    bool dry_run = false;      ///< only say what would be made
    std::string output;        ///< folder for what the engine makes; empty: a folder of the job's name in the current one
    int processes = 1;         ///< of the local engine: tasks at once
    bool chunk_ranges = true;  ///< of OpenJD: chunks by the extension TASK_CHUNKING; false: pairs of first and last frame
    std::string again;         ///< the command that makes the same job again, for a shell
};

/// What runs the steps of a job, or writes them in the form that a scheduler takes.
struct FarmEngine {
    std::string name;
    std::string doc;  ///< one clause, for the help
    /// Prints what it did. @return an exit code @throws Failure
    std::function<int(const FarmJob& job, const FarmRequest& request)> farm;
};

/// All engines, in the order of the help.
const std::vector<FarmEngine>& farm_engines();

/// The engine of a name; null: there is none.
const FarmEngine* find_engine(const std::string& name);

/// The job as text: its steps, what each waits for, tasks, frames, resources and the command of its first task.
std::string to_text(const FarmJob& job);

}  // namespace fluidcarve
