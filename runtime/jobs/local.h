#pragma once

#include "runtime/jobs/engine.h"

namespace fluidcarve {

/// Runs the tasks of a job as processes of this machine, FarmRequest::processes in parallel, each
/// after the steps that it needs. The output of a task goes to a log in the job's folder. A task
/// that is killed from outside runs once more. After a failure, tasks that do not depend on it
/// continue.
int farm_locally(const FarmJob& job, const FarmRequest& request);

}  // namespace fluidcarve
