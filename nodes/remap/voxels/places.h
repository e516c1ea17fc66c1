#pragma once

#include "nodes/lattice/alignment.h"
#include "nodes/lattice/block_places.h"
#include "nodes/seams/carve_map.h"

#include <array>
#include <memory>
#include <optional>

namespace fluidcarve {

/// Where the voxels of a carved grid stand in the carved lattice, one 8^3 block at a time: at whole vertices where they
/// are the lattice's vertices (remap_aligned.h), else as BlockPlaces says (remap_sampled.h).
class CarvedPlaces {
public:
    /// Lattice index coordinates of eight voxels along z.
    struct Row {
        unsigned inside = 0;  ///< bit z: voxel z lies in the lattice, or where insertions extend it
        std::array<openvdb::Vec3d, 8> at;
    };

    /// @param transform  of the grid; must outlive this and its copies
    /// @param cells      of the voxels with which the grid's values travel: the same, but for a component on faces
    /// @param extent     CarveMap::reach
    CarvedPlaces(const Lattice& lattice, const std::array<int, 3>& extent, const openvdb::math::Transform& transform, const openvdb::math::Transform& cells);

    /// Whether voxels are vertices; components of a staggered grid then stand at their voxel.
    bool aligned() const { return alignment_.has_value(); }
    const Mapping& mapping() const { return *mapping_; }
    /// All voxels in a box of lattice coordinates, and a few more.
    openvdb::CoordBBox voxels(const openvdb::BBoxd& range) const;

    /// Turns to a block.
    /// @return lattice coordinates that its voxels, and points up to half a voxel below them, may have; empty if none has any
    openvdb::BBoxd move_to(const openvdb::Coord& block);
    /// @param first   the first voxel of a row of the block
    /// @param offset  added to each voxel: that many voxels, each 0 or -1/2; 0 if aligned()
    void locate(const openvdb::Coord& first, const openvdb::Vec3d& offset, Row& row);

private:
    std::array<int, 3> extent_;
    std::optional<Alignment> alignment_;
    std::shared_ptr<const Mapping> mapping_;
    const openvdb::math::Transform* transform_;
    BlockPlaces places_;
    BlockPlaces::Row found_;
};

}  // namespace fluidcarve
