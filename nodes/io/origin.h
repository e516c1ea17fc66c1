#pragma once

#include <openvdb/openvdb.h>

#include <memory>
#include <vector>

namespace fluidcarve {

/// Where a file's space sits in the shot's world: `world = scale * file + translate`.
struct Placement {
    openvdb::Vec3d translate{0};
    double scale = 1;
    openvdb::Vec3d offset{0};  ///< added before, in voxels along the grid's axes: what an application leaves out of the transform
    bool operator==(const Placement&) const = default;
};

openvdb::math::Transform::Ptr placed(const openvdb::math::Transform& in_file, const Placement& placement);

/// What a reader knows of a grid and a writer needs to give it back as it came. It travels with the grid as metadata
/// that stays in memory: copies of the grid share it, files never hold it.
struct Origin {
    Placement placement;
    openvdb::math::Transform::ConstPtr in_file;  ///< null if the placement moves nothing

    /// The three grids (`vel.x`, `vel.y`, `vel.z`) that were read as one of vectors, or none.
    std::vector<openvdb::FloatGrid::ConstPtr> components;
    std::weak_ptr<const openvdb::TreeBase> merged;  ///< the tree made of them

    bool made_staggered = false;  ///< by the reader's profile; the file says that the class is unknown, or nothing
    bool class_in_file = false;   ///< it says so
};

void set_origin(openvdb::GridBase& grid, Origin origin);
/// Null if nobody set one.
std::shared_ptr<const Origin> origin_of(const openvdb::GridBase& grid);

/// The grid in the shot's world: a shallow copy that remembers where it was. The grid itself if the placement moves nothing.
openvdb::GridBase::ConstPtr placed(const openvdb::GridBase::ConstPtr& grid, const Placement& placement);
/// The grid in its file's space again, bit for bit as it was if it came from there, and without its origin.
/// @param placement  null: the one of the origin, if there is one; else the origin's offset is undone with it
openvdb::GridBase::ConstPtr unplaced(const openvdb::GridBase::ConstPtr& grid, const Placement* placement);

}  // namespace fluidcarve
