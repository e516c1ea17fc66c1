#pragma once

#include <string>
#include <vector>

namespace fluidcarve {

/// A text file that an engine makes for its scheduler.
struct JobFile {
    std::string name;  ///< in the job's folder
    std::string text;
    bool runs = false;  ///< it is a program
};

/// A text in the last file of a job. It marks the files as a job's, so that a later job may
/// replace them.
inline constexpr const char* job_mark = "fluidcarve farm";

/// Writes the files of a job, each whole or not at all; the last one starts the job, holds
/// `job_mark`, and is written after all others.
/// @throws Failure if a foreign file has one of the names, or the folder can't be written to; then
///   nothing is written
void write_job_files(const std::string& folder, const std::vector<JobFile>& files);

}  // namespace fluidcarve
