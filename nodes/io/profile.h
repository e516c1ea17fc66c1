#pragma once

#include "nodes/io/vdb_file.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// How an application names and means the grids of its volumes.
struct Profile {
    std::string_view name;         ///< "houdini"
    std::string_view application;  ///< "Houdini"
    struct Alias {
        std::string_view common;               ///< the name that pipelines use, whoever made the file: "velocity"
        std::vector<std::string_view> inside;  ///< its names in files, the usual one first; "vel" may be a triplet
    };
    std::vector<Alias> grids;
    bool staggered = false;          ///< velocities stand on the faces, also where the grid's class doesn't say so
    std::string_view velocity_unit;  ///< for people
    bool points_off = false;         ///< points stand half a voxel above where they are against the grids, along each axis
};

/// Blender, Houdini, EmberGen, Bifrost.
std::span<const Profile> profiles();
/// Null if there is none of that name.
const Profile* profile(std::string_view name);

/// The profile whose names, and marks in the file's metadata, a file bears; null if none or several fit.
const Profile* detected_profile(const VdbHeader& header);

/// What the file calls a grid that a pipeline asks for: the name itself if the file has it (a triplet counts), else the
/// first of the profile's that it has, else the name.
std::string name_in_file(const VdbHeader& header, const Profile* profile, const std::string& name);

}  // namespace fluidcarve
