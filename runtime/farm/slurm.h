#pragma once

#include "runtime/farm/engine.h"
#include "runtime/farm/job_files.h"

#include <vector>

namespace fluidcarve {

/// A job as batch scripts for Slurm: one for each step, `STEP.sbatch`, and `submit`, which hands them to sbatch. A step is an array with a
/// task for each chunk of frames; it starts once all tasks of the steps that it needs have ended well, and is cancelled when that can't be
/// any more. A task that fails is started again twice, one whose machine fell out as often as that happens.
std::vector<JobFile> slurm_files(const FarmJob& job);

/// Writes the scripts into a folder. With `submit` it runs `submit` there. Prints what it did, or with `dry_run` what the scripts would be.
/// @return an exit code @throws Failure if the folder can't be written to, or sbatch is wanted and not there; then nothing is submitted
int farm_slurm(const FarmJob& job, const FarmRequest& request);

}  // namespace fluidcarve
