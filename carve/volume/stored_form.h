#pragma once

#include <openvdb/openvdb.h>

#include <memory>
#include <vector>

namespace fluidcarve {

/// Placement of a file's space in the shot's world: `world = scale * file + translate`.
struct Placement {
    openvdb::Vec3d translate{0};  ///< world units
    double scale = 1;
    openvdb::Vec3d offset{0};  ///< voxels along the grid's axes, added to index coordinates first:
                               ///< an offset missing in the file's transform
    bool operator==(const Placement&) const = default;
};

/// The transform in the shot's world.
openvdb::math::Transform::Ptr placed(const openvdb::math::Transform& in_file,
                                     const Placement& placement);

/// How a grid was stored in its file, so that a writer can write it back unchanged. It travels with
/// the grid as metadata that exists only in memory: copies of the grid share it, files never hold
/// it.
struct StoredForm {
    Placement placement;
    /// Transform in the file; null if the placement moves nothing.
    openvdb::math::Transform::ConstPtr in_file;

    /// The three float grids (`vel.x`, `vel.y`, `vel.z`) that were merged into one vector grid, or
    /// none.
    std::vector<openvdb::FloatGrid::ConstPtr> components;
    std::weak_ptr<const openvdb::TreeBase> merged;  ///< the tree of that vector grid

    bool made_staggered = false;  ///< the reader's profile set the class to staggered; in the file
                                  ///< it is unknown or not stated
    bool class_in_file = false;   ///< the file states the class `unknown`
};

void set_stored_form(openvdb::GridBase& grid, StoredForm stored);
/// How a grid was stored; null if it has none.
std::shared_ptr<const StoredForm> stored_form_of(const openvdb::GridBase& grid);

/// The grid in the shot's world: a shallow copy with a stored form. The grid itself if the
/// placement moves nothing.
openvdb::GridBase::ConstPtr placed(const openvdb::GridBase::ConstPtr& grid,
                                   const Placement& placement);
/// The grid in its file's space, without its stored form. If it has the reader's placement, its
/// transform is bit for bit that of the file.
/// @param placement  the placement to undo, with the offset of the stored form; null: that of the
///   stored form, if there is one
openvdb::GridBase::ConstPtr unplaced(const openvdb::GridBase::ConstPtr& grid,
                                     const Placement* placement);

}  // namespace fluidcarve
