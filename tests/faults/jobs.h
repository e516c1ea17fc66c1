#pragma once

#include <string>
#include <vector>

namespace faults {

/// A small run of the program in a folder of its own, which it leaves nothing in but `out/` and
/// `work/`.
struct Job {
    std::string name;
    /// Commands that run first, without faults; {} is the program.
    std::vector<std::string> before;
    std::string command;    ///< the one that calls fail in
    std::string then = {};  ///< a command that ends well after one that did, since it finds what
                            ///< that kept; empty: nothing is to be kept
};

/// One of each kind: carving, solving, files of seams, the work folder, pages, reports, images,
/// farms.
const std::vector<Job>& jobs();

/// Puts the inputs of all jobs and their pipelines into a folder, and files of others into its
/// `out/` and `work/`.
void furnish(const std::string& folder);

/// The paths of the files that are not the program's, in a furnished folder.
const std::vector<std::string>& foreign_files();

}  // namespace faults
