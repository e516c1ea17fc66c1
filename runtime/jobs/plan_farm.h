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
    std::vector<std::string> pipeline;  ///< words after it: `run`, the pipeline and what is set in
                                        ///< it; they give the job its name
    std::vector<std::string> options;   ///< words after these
    std::string again;                  ///< the command that makes the job again, for a shell
};

/// Makes a job of a run: its steps, cut into tasks. Looks at the inputs as `plan` does, and prints
/// what is wrong with them.
/// @param request  its work folder is absolute
/// @return nothing if something is wrong
std::optional<FarmJob> plan_farm(const Pipeline& pipeline, const Registry& registry,
                                 const RunRequest& request, const FarmChunking& chunking,
                                 const FarmCommand& command);

}  // namespace fluidcarve
