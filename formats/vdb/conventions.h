#pragma once

#include "formats/vdb/vdb_file.h"

#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// Conventions of an application for the grids in its .vdb files.
struct Conventions {
    std::string_view name;         ///< "houdini"
    std::string_view application;  ///< "Houdini"
    struct Alias {
        std::string_view common;               ///< name in pipelines: "velocity"
        std::vector<std::string_view> inside;  ///< names in files of the application, the usual one
                                               ///< first; "vel" may be a triplet
    };
    std::vector<Alias> grids;
    bool staggered = false;  ///< velocities are on voxel faces even if the grid's class is unknown
    std::string_view velocity_unit;  ///< in words
    bool points_off = false;  ///< point positions in files are half a voxel too high along each
                              ///< axis, relative to the grids
};

/// The conventions of this name, or null.
const Conventions* conventions_of(std::string_view name);

/// The only conventions that fit a file's grid names and metadata; null if none or several fit.
const Conventions* detected_conventions(const VdbHeader& header);

/// The name in the file of a grid that a pipeline asks for: the name itself if the file has it (a
/// triplet counts), else the conventions' first name that the file has, else the name itself.
std::string name_in_file(const VdbHeader& header, const Conventions* conventions,
                         const std::string& name);

}  // namespace fluidcarve
