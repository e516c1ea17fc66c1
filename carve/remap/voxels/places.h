#pragma once

#include "carve/lattice/alignment.h"
#include "carve/lattice/block_places.h"
#include "carve/seam/carve_map.h"

#include <array>
#include <memory>
#include <optional>

namespace fluidcarve {

/// Finds where the voxels of a carved grid lie in the carved lattice, one 8^3 block at a time: at
/// whole vertices if voxels are vertices (aligned.h), else by BlockPlaces (sampled.h).
class CarvedPlaces {
public:
    /// Lattice index coordinates of eight voxels along z.
    struct Row {
        /// Bit z is set if voxel z lies in the lattice, or where insertions extend it.
        unsigned inside = 0;
        std::array<openvdb::Vec3d, 8> at;
    };

    /// @param extent     CarveMap::reach
    /// @param transform  of the grid; must outlive this object and its copies
    /// @param cells      of the voxels with which the grid's values travel: the same as
    ///   `transform`, except for a component on faces
    CarvedPlaces(const Lattice& lattice, const std::array<int, 3>& extent,
                 const openvdb::math::Transform& transform, const openvdb::math::Transform& cells);

    /// Whether voxels are vertices. Components of a staggered grid then stand at their voxel.
    bool aligned() const { return alignment_.has_value(); }
    const Mapping& mapping() const { return *mapping_; }
    /// Index box of all voxels in a box of lattice coordinates, with a margin.
    openvdb::CoordBBox voxels(const openvdb::BBoxd& range) const;

    /// Moves to a block.
    /// @param block  the block's first voxel
    /// @return box around the lattice coordinates of the block's voxels and of points up to half a
    ///   voxel below them; empty if there are none
    openvdb::BBoxd move_to(const openvdb::Coord& block);
    /// Finds the lattice coordinates of a row of the block.
    /// @param first   first voxel of the row
    /// @param offset  added to each voxel, voxels; each component is 0 or -1/2; 0 if aligned()
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
