#pragma once

#include "carve/points/point_image.h"
#include "carve/points/point_table.h"
#include "carve/volume/stored_form.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace fluidcarve {

/// Points with attributes: a point grid of a VDB file, or the vertices of a PLY file. They are kept
/// in the form of their file, so that unchanged points are written back bit for bit. Points are in
/// the order of the grid, or of the PLY file.
struct Points {
    /// An openvdb::points::PointDataGrid in the shot's world, or null.
    openvdb::GridBase::ConstPtr grid;
    openvdb::MetaMap metadata;              ///< metadata of the VDB file
    std::string codec;                      ///< as Volume::codec
    std::shared_ptr<const PointTable> ply;  ///< PLY vertices in the file's space, or null
    Placement placement;                    ///< placement of `ply`

    std::size_t size() const;
    std::uint64_t bytes() const;
    /// World positions.
    std::vector<openvdb::Vec3d> positions() const;
    /// A number per point that does not depend on other points: its attribute `id` if that is an
    /// integer (the same in all frames), else a hash of its position.
    std::vector<std::uint64_t> identities() const;
    /// Whether there is an attribute `id` that is an integer.
    bool has_ids() const;
};

/// A point set made of points of the source. Attributes, groups and text tables are kept.
/// @param images  the points of the result, sorted by source; source points without an image are
///   removed
/// @param more    further source points, numbered after those of `source`; alike(source, more),
///   and their images all moved
Points with_images(const Points& source, const std::vector<PointImage>& images,
                   const Points* more = nullptr);

/// The points as a grid in the shot's world, with a stored form (stored_form.h).
openvdb::GridBase::ConstPtr in_grid(const Points& points);

/// Whether the points of two sets have the same attributes, so that one set can hold both.
bool alike(const Points& a, const Points& b);

}  // namespace fluidcarve
