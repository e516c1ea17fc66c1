#pragma once

#include <openvdb/openvdb.h>
#include <nlohmann/json.hpp>

#include <array>
#include <string>
#include <vector>

namespace fluidcarve {

/// What the files of a sequence hold, as far as a pipeline must know.
struct Contents {
    enum class Matter { smoke, fire, level_set, particles, image, mesh };
    Matter matter = Matter::smoke;
    bool liquid() const { return matter == Matter::level_set || matter == Matter::particles; }
    std::string main;  ///< name of the grid or channel that is looked at; of particles in a volume,
                       ///< of their grid
    std::string flame;        ///< of fire: name of the grid of flames; may be `main`
    std::string velocity;     ///< name of the grid of velocities, on the voxels of `main` or of the
                              ///< particles; empty: none
    bool vectors = false;     ///< `main` holds vectors
    bool in_volume = false;   ///< the files are VDB files
    bool alone = false;       ///< particles: no other grids lie beside them
    bool identified = false;  ///< particles: they have an `id`
    double voxel = 1;   ///< edge of a voxel, or of one that suits particles or a mesh; world units
    bool y_up = false;  ///< y points up, not z
    std::string profile;              ///< name of the application's profile; empty: unknown
    openvdb::BBoxd box;               ///< around the content, in the files' world
    std::vector<std::string> floats;  ///< names of all float grids or channels that every file has
    double highest = 1;  ///< largest size of a value of `main` in the files that were looked at
    std::vector<std::string> same;  ///< further grids of the name and type of `main`
    std::array<std::string, 3> source{
        "middle", "middle",
        "middle"};  ///< which end stays in place when x, y or z is carved (source_of)
};

/// Finds what is to be carved by types and names of grids. Grids without content, or with one value
/// everywhere, do not count.
/// @param facts  of some files of the sequence, as FileInspector::look describes them; at least one
/// @throws Failure (input) if there is nothing that can be carved
Contents contents_of(const std::vector<nlohmann::ordered_json>& facts);

}  // namespace fluidcarve
