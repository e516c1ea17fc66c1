#pragma once

#include "tests/bench/large/make.h"

#include <string>
#include <vector>

/// A row of the paper's table 2. The paper's second dimension, its height, is our z.
struct TableScene {
    std::string name;                ///< of the row, and of its folder in a folder of data
    std::vector<std::string> files;  ///< in that folder; the first that there is
    openvdb::Coord size;             ///< voxels
    int frames;
    bool velocity;  ///< whether its pipeline takes it
    int count;      ///< seams
    int bytes;      ///< of a vertex in a frame, while the solver runs: 6 with a field, 2 without
    double paper_greedy;  ///< seconds a seam
    double paper_remap;   ///< seconds; 0: not stated
};

const std::vector<TableScene>& table_scenes();

/// A scene's small sequence. @throws std::runtime_error if the folder of data has none
std::string files_of(const TableScene& scene, const std::string& folder);

/// Prepares the shipped pipeline for a made sequence: what stands in the small sequence's world is
/// stretched as it was.
/// @param folder   of data
/// @param scratch  folder in which stretched curves and meshes, and a pipeline, may be written
/// @return the arguments of `run`: the pipeline, and all that is set but files and frames
std::string arguments_for(const TableScene& scene, const Made& made, const std::string& folder,
                          const std::string& scratch);
