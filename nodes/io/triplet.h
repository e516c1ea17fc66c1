#pragma once

#include "nodes/payloads.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// A velocity as Houdini's simulations keep it: three float grids `vel.x`, `vel.y`, `vel.z`. Either all stand on the
/// voxels' centres, or each on the faces below them along its axis (OpenVDB's GRID_STAGGERED), its transform half a
/// voxel off.
struct Triplet {
    std::string name;  ///< without the ending: "vel"
    std::array<FloatGrid::ConstPtr, 3> components;
    bool staggered = false;
    openvdb::math::Transform::ConstPtr cells;  ///< of the voxels
};

/// The names of the three.
std::array<std::string, 3> triplet_names(const std::string& name);

/// @throws Failure naming the grids if their transforms are neither those of one grid nor those of faces
Triplet make_triplet(const std::string& name, const std::array<FloatGrid::ConstPtr, 3>& components);

/// The triplet that a grid of a volume belongs to, if it is one of three whose transforms fit, else nothing.
std::optional<Triplet> triplet_of(const Volume& volume, const openvdb::GridBase& grid);

/// One grid of vectors: active where any component is. It remembers where it came from (origin.h).
VectorGrid::ConstPtr merged(const Triplet& triplet);

/// The three grids again that a grid was merged from, in the shot's world; the grid itself if it was not. Where nothing
/// changed it they are the very grids; otherwise each keeps its metadata and, where it changed, is active where
/// the vectors are.
std::vector<openvdb::GridBase::ConstPtr> split(const openvdb::GridBase::ConstPtr& grid);

}  // namespace fluidcarve
