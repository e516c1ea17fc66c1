#pragma once

#include "graph/pipeline.h"

#include <string>
#include <vector>

namespace fluidcarve {

/// The place of the files that a parameter names.
struct FilePlace {
    std::string node, field;
    std::string path;      ///< absolute, with its frame token
    bool writes = false;   ///< an output
    bool found = false;    ///< of an input: whether a file of any frame is there
    std::string tried_at;  ///< of an input that is not found: the other absolute path at which it
                           ///< was looked for, or empty
};
using FilePlaces = std::vector<FilePlace>;

/// The files of all parameters that name some, node by node. Only checks whether files exist.
FilePlaces file_places(const Pipeline& pipeline);

/// One line each, below `files:`: `sim.path is read at /shots/sim.####.vdb`.
std::string to_text(const FilePlaces& places);

/// How the pipeline uses a file: "'sim' reads it", "it is the pipeline"; empty if it does not.
/// Checked before writing to the file.
std::string user_of(const Pipeline& pipeline, const std::string& path);

}  // namespace fluidcarve
