#pragma once

#include <openvdb/Types.h>
#include <openvdb/math/Coord.h>

#include <cstdint>
#include <functional>
#include <string>

/// A large sequence that is to be made of a small one.
struct MakeRequest {
    std::string files;    ///< the small one: a path with `####`
    openvdb::Coord size;  ///< voxels that the box around its content becomes
    int frames = 2;       ///< that its time becomes; 2 or more
    int first_only = 0;   ///< above 0: makes only so many of them
    double active = 1;  ///< largest share of voxels that are active in a frame; thin smoke is left
                        ///< out until it holds
    bool velocity = false;  ///< writes it, too
    std::string out;        ///< a path with `####`; frames count from 1
};

/// What was made.
struct Made {
    openvdb::Vec3d stretch;  ///< along x, y, z: world positions of the small sequence, times this,
                             ///< are those of the large one
    double voxel = 0;        ///< world units
    int frames = 0;
    std::uint64_t active = 0;  ///< voxels, in the frame with most
    std::uint64_t bytes = 0;   ///< on the disk
};

/// Makes a sequence of any size from a simulation: enlarged smoothly in space, between its frames
/// moved along its flow. Detail is added down to four voxels: swirls that displace it and make it
/// thicker and thinner, carried along by the flow. Frames are made one by one; the same request
/// makes the same grids. Grids, in half floats: density, flame if there is one, velocity
/// (collocated, in the simulation's units).
/// @param tick  called after each frame, with its number from 1
/// @throws std::runtime_error, Failure if a file can't be read or written, or the request makes no
///   sense
Made make_sequence(const MakeRequest& request, const std::function<void(int)>& tick);
