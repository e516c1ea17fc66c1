#pragma once

#include "runtime/jobs/engine.h"

namespace fluidcarve {

/// Runs the tasks of a job as processes of this machine, so many at once, each after the steps that
/// it needs. What a task prints goes to a log in the job's folder. A task that is killed from
/// outside runs once more. After a failure, tasks that do not need it go on.
int farm_locally(const FarmJob& job, const FarmRequest& request);

}  // namespace fluidcarve
