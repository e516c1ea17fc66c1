#pragma once

#include <string>
#include <vector>

struct TableRequest {
    std::string folder;                         ///< of small sequences, as tests/data
    std::string out;                            ///< written: OUT.md, again after each row
    std::vector<std::string> only;              ///< names of rows; none: all
    int frames = 0;                             ///< above 0: no more of each row
    std::string memory = "8G";                  ///< as of run
    std::string scratch = "out/table_scratch";  ///< sequences and results; deleted row by row
};

/// The paper's table 2, with whole pipelines: each row's sequence is made at the paper's size and
/// carved by the shipped pipeline, in runs of their own for the energies, the seams of both
/// solvers, and the remap. Where the disk is too small for all frames: as many as fit.
/// @throws std::runtime_error, Failure if a sequence is missing or a run fails
void measure_table(const TableRequest& request);
