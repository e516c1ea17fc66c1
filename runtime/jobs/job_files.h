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

/// What the last file of a job holds, so that a later job may replace the files.
inline constexpr const char* job_mark = "fluidcarve farm";

/// Writes the files of a job, each whole or not at all; the last one, by which the job is begun and
/// which bears `job_mark`, after all others.
/// @throws Failure if a file of others has such a name, or the folder can't be written to; then
///   nothing is written
void write_job_files(const std::string& folder, const std::vector<JobFile>& files);

}  // namespace fluidcarve
