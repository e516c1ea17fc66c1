#pragma once

#include "runtime/jobs/engine.h"
#include "runtime/jobs/job_files.h"

#include <string>
#include <vector>

namespace fluidcarve {

/// A job as a bundle for Open Job Description (specification 2023-09) and AWS Deadline Cloud: the
/// template, the values of its parameters, and the files that travel with it. Each file and folder
/// that the pipeline reads or writes is a parameter of type PATH, so that a scheduler may relocate
/// it. Its default is relative to the bundle.
/// @param folder        of the bundle, absolute
/// @param chunk_ranges  steps get frames as a parameter CHUNK[INT] of the extension TASK_CHUNKING;
///   false: as pairs of first and last frame
/// @throws Failure if the job exceeds a limit of the specification
std::vector<JobFile> openjd_files(const FarmJob& job, const std::string& folder, bool chunk_ranges);

/// Why `--submit` is refused: schedulers take bundles from their folder.
std::string openjd_refusal(const FarmRequest& request);

/// Writes the bundle into a folder.
/// @return an exit code
/// @throws Failure also if the folder can't be written to
int farm_openjd(const FarmJob& job, const FarmRequest& request);

}  // namespace fluidcarve
