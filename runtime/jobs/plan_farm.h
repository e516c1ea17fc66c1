#pragma once

#include "runtime/jobs/job.h"
#include "runtime/run/run.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

/// What every task of a job shares.
struct FarmCommand {
    /// Name and value of the variables that tasks need.
    std::vector<std::pair<std::string, std::string>> environment;
    std::vector<std::string> prefix;    ///< words before the program
    std::string executable;             ///< the program
    std::vector<std::string> pipeline;  ///< words after it: `run`, the pipeline and its settings;
                                        ///< they determine the job's name
    std::vector<std::string> options;   ///< words after these
    std::string again;                  ///< the shell command that makes the job again
};

/// Makes a job of a run: its steps, cut into tasks. Checks the inputs as `plan` does, and prints
/// what fails.
/// @param request  its work folder is absolute
/// @return nothing if an input fails
std::optional<FarmJob> plan_farm(const Pipeline& pipeline, const Registry& registry,
                                 const RunRequest& request, const FarmChunking& chunking,
                                 const FarmCommand& command);

}  // namespace fluidcarve
