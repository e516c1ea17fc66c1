#pragma once

#include "carve/volume/volume.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// A velocity as three float grids, as Houdini's simulations write it: `vel.x`, `vel.y`, `vel.z`.
/// Their values are either all at the voxel centres, or each at the lower face along its axis
/// (OpenVDB's GRID_STAGGERED); then its transform is shifted by half a voxel.
struct Triplet {
    std::string name;  ///< common name, without ".x": "vel"
    std::array<FloatGrid::ConstPtr, 3> components;
    bool staggered = false;
    openvdb::math::Transform::ConstPtr cells;  ///< transform of the voxel centres
};

/// Names of the three grids: "vel.x", "vel.y", "vel.z".
std::array<std::string, 3> triplet_names(const std::string& name);

/// @throws Failure naming the grids if their transforms are neither equal nor those of voxel faces
Triplet make_triplet(const std::string& name, const std::array<FloatGrid::ConstPtr, 3>& components);

/// The triplet that a grid of a volume belongs to; nothing if there is none, or its transforms do
/// not fit.
std::optional<Triplet> triplet_of(const Volume& volume, const openvdb::GridBase& grid);

/// Merges a triplet into one vector grid, active where any component is. Its stored form
/// (stored_form.h) holds the components.
VectorGrid::ConstPtr merged(const Triplet& triplet);

/// Splits a merged grid into its three components, in the shot's world; any other grid is returned
/// alone. An unchanged grid gives the original components. Otherwise they keep their metadata, and
/// each is active where the vectors are, except that unchanged voxels keep the component's own
/// state.
std::vector<openvdb::GridBase::ConstPtr> split(const openvdb::GridBase::ConstPtr& grid);

}  // namespace fluidcarve
