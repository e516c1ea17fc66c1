#pragma once

#include <map>
#include <string_view>

namespace fluidcarve {

/// Parts of the scripts of a Slurm job, by name: runtime/jobs/*.sh. Compiled into the program.
///   slurm_task.sh       what a task does after its script has set `chunks`, `command`, `folder`
///   slurm_submit.sh     what `submit` does after it has set `name` and `status`, before it calls
///                       `step`
///   slurm_submitted.sh  what `submit` does after it has called `step`
const std::map<std::string_view, std::string_view>& slurm_texts();

}  // namespace fluidcarve
