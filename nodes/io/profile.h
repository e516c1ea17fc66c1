#pragma once

#include "nodes/io/vdb_file.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// Conventions of an application for the grids in its .vdb files.
struct Profile {
    std::string_view name;         ///< "houdini"
    std::string_view application;  ///< "Houdini"
    struct Alias {
        std::string_view common;               ///< name in pipelines: "velocity"
        std::vector<std::string_view> inside;  ///< names in files of the application, the usual one first; "vel" may be a triplet
    };
    std::vector<Alias> grids;
    bool staggered = false;          ///< velocities are on voxel faces even if the grid's class is unknown
    std::string_view velocity_unit;  ///< in words
    bool points_off = false;         ///< point positions in files are half a voxel too high along each axis, relative to the grids
};

/// The profiles of Blender, Houdini, EmberGen and Bifrost.
std::span<const Profile> profiles();
/// The profile of this name, or null.
const Profile* profile(std::string_view name);

/// The only profile that fits a file's grid names and metadata; null if none or several fit.
const Profile* detected_profile(const VdbHeader& header);

/// The name in the file of a grid that a pipeline asks for: the name itself if the file has it (a triplet counts), else the profile's
/// first name that the file has, else the name itself.
std::string name_in_file(const VdbHeader& header, const Profile* profile, const std::string& name);

}  // namespace fluidcarve
