#pragma once

#include "runtime/jobs/job.h"

#include <string>

namespace fluidcarve {

/// Writes a job into its work folder, for its tasks and for `status`. The records of tasks of an
/// earlier job of this name stay.
/// @param engine  its name @throws Failure if the work folder can't be written to
void record_job(const FarmJob& job, const std::string& engine);

/// What the verb `status` prints: the jobs of farms in a work folder, the progress of their steps,
/// what failed and how to continue; then the runs (status_text).
/// @param json  for programs, as pipelines/FORMATS.md says
std::string job_status_text(const std::string& work_folder, bool json);

}  // namespace fluidcarve
