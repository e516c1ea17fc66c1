#pragma once

#include "nodes/io/origin.h"
#include "nodes/points/ply.h"
#include "nodes/points/point_image.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace fluidcarve {

/// Points with attributes, as their file holds them, so that what nothing changes is given back bit for bit: a point grid of a VDB
/// file, or the vertices of a PLY file. Points have an order: the grid's, or the file's.
struct Points {
    openvdb::GridBase::ConstPtr grid;      ///< an openvdb::points::PointDataGrid in the shot's world, or null
    openvdb::MetaMap metadata;             ///< of the VDB file
    std::string codec;                     ///< as Volume::codec
    std::shared_ptr<const PlyPoints> ply;  ///< in its file's space, or null
    Placement placement;                   ///< of `ply`

    std::size_t size() const;
    std::uint64_t bytes() const;
    /// World positions.
    std::vector<openvdb::Vec3d> positions() const;
    /// A number per point that depends on nothing else: its attribute `id` if that is a whole number, which follows it through the
    /// frames, else made of its position.
    std::vector<std::uint64_t> identities() const;
};

/// The source with only these of its points. Attributes, groups and text tables stay with their points.
/// @param images  rising by source; points that are not there are deleted
Points with_images(const Points& source, const std::vector<PointImage>& images);

}  // namespace fluidcarve
