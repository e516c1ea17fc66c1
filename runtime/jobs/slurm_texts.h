#pragma once

#include <map>
#include <string_view>

namespace fluidcarve {

/// Parts of the scripts of a Slurm job, by name: runtime/jobs/*.sh. Compiled into the program.
///   slurm_task.sh       what a task's script does after it has set `chunks`, `command` and `folder`
///   slurm_submit.sh     what `submit` does after it has set `name` and `status`, before its calls
///                       of `step`
///   slurm_submitted.sh  what `submit` does after its calls of `step`
const std::map<std::string_view, std::string_view>& slurm_texts();

}  // namespace fluidcarve
