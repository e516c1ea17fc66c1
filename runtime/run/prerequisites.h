#pragma once

#include "runtime/run/preparation.h"
#include "runtime/run/request.h"

#include <functional>
#include <string>
#include <vector>

namespace fluidcarve {

/// Why a task of a farm can't begin: it does not see the folder of its job, and so would not see
/// the results of other tasks. Empty: it does.
std::string fault_of_task_folder(const RunRequest& request, const std::function<bool()>& cancelled);

/// A schedule, and what it lacks.
struct Prerequisites {
    Schedule schedule;
    std::vector<NodeDemand> demands;   ///< of the schedule
    std::vector<NodeFailure> missing;  ///< for each node whose required results are not in the work
                                       ///< folder; empty: the run may begin
};

/// Makes the schedule of a run. With `--only`, the run makes only its targets; with `--wait`, it
/// leaves results that are a farm step of their own (digests_apart, gathers_apart) to other runs.
/// If such results are not in the work folder, waits for up to the time of `--wait`: on NFS, files
/// of other machines show late.
/// @param cancelled  asked often while it waits; true: wait no longer
Prerequisites wait_for_prerequisites(const Pipeline& pipeline, Preparation& prepared,
                                     const RunRequest& request,
                                     const std::function<bool()>& cancelled);

}  // namespace fluidcarve
