#pragma once

#include "tests/fuzz/vdb_places.h"

#include <string>
#include <vector>

namespace fuzz {

/// A sound file from which mutants are made.
struct Source {
    std::string ending;  ///< of its name: ".ply"
    std::string bytes;
    std::string pipeline = {};       ///< that reads it; empty where that is up to the campaign
    std::vector<Place> places = {};  ///< of VDB files
};

/// Sound files of all kinds, small ones: of the test data, and written by the program itself.
struct Sources {
    std::vector<Source> volumes, points, seams, images, meshes, curves, pipelines;
};

/// @param program  path of the program
/// @param folder   where it writes files; some must stay while mutants are run
/// @throws std::runtime_error if it can't write them
Sources make_sources(const std::string& program, const std::string& folder);

}  // namespace fuzz
