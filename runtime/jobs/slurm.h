#pragma once

#include "runtime/jobs/engine.h"
#include "runtime/jobs/job_files.h"

#include <string>
#include <vector>

namespace fluidcarve {

/// A job as batch scripts for Slurm: one for each step, `STEP.sbatch`, and `submit`, which hands
/// them to sbatch. A step is an array with a task for each chunk of frames; it starts once all
/// tasks of the steps that it needs have succeeded, and is cancelled when that becomes impossible.
/// A task that fails is restarted twice, a task whose machine fails every time.
std::vector<JobFile> slurm_files(const FarmJob& job);

/// Why the job can't be submitted: there is no sbatch.
std::string slurm_refusal(const FarmRequest& request);

/// Writes the scripts into a folder. With `submit` it runs `submit` there.
/// @return an exit code
/// @throws Failure if the folder can't be written to
int farm_slurm(const FarmJob& job, const FarmRequest& request);

}  // namespace fluidcarve
