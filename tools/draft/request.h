#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

/// What a pipeline is to be drafted for. Empty paths of outputs: the pipeline has no such writer.
struct DraftRequest {
    std::string input;   ///< path of the files, with a frame token if there are several
    std::string frames;  ///< those that are there, as text; empty: `input` is one file
    /// What some of the files hold, as FileInspector::look describes it; at least one.
    std::vector<nlohmann::ordered_json> facts;
    std::string out;             ///< path of the carved files
    std::string seams;           ///< path of the seams
    std::string sheet;           ///< path of the picture
    std::string count = "-20%";  ///< of seams
    char axis = 'x';             ///< x, y or z of the files; w: upwards; t: frames
    std::string solver;          ///< node type; empty: what suits the content
    /// Each `GRID=VALUE`, or the path of a mesh or, for images, of a picture.
    std::vector<std::string> protect;
    using Fields = std::vector<std::pair<std::string, std::string>>;
    Fields solver_fields;  ///< parameters of the solver, as YAML on one line
    Fields remap_fields;   ///< of the nodes that carve
};

}  // namespace fluidcarve
