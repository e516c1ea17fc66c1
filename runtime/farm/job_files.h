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

/// Writes the files of a job, each whole or not at all; the last one, by which the job is begun, after all others.
/// @throws Failure if the folder holds files of others, or can't be written to; then nothing is written
void write_job_files(const std::string& folder, const std::vector<JobFile>& files);

}  // namespace fluidcarve
