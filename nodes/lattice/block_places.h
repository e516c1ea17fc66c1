#pragma once

#include "nodes/lattice/mapping.h"

#include <openvdb/math/Coord.h>
#include <openvdb/math/Transform.h>

namespace fluidcarve {

/// Where the voxels of a grid stand in a lattice, one 8^3 block at a time: what Mapping::locate says of each, but the
/// slabs that meet the block are looked up once, and along a row of voxels all products are affine.
class BlockPlaces {
public:
    struct Place {
        openvdb::Vec3d at;    ///< lattice index coordinates
        openvdb::Vec3d u, v;  ///< to the next vertex along u and v, index units; not set in a straight box or by the closed form
    };
    /// Eight voxels along z.
    struct Row {
        unsigned inside = 0;  ///< bit z: voxel z lies in the lattice, and has a place
        std::array<Place, 8> places;
    };
    /// Index coordinates of eight points.
    struct Positions {
        std::array<std::array<double, 8>, 3> xyz;
        openvdb::Vec3d at(std::size_t n) const { return {xyz[0][n], xyz[1][n], xyz[2][n]}; }
        void set(std::size_t n, const openvdb::Vec3d& to) {
            for (std::size_t axis = 0; axis < 3; ++axis) xyz[axis][n] = to[static_cast<int>(axis)];
        }
    };

    /// @param mapping, transform  must outlive this and its copies, which share all that does not depend on a block
    BlockPlaces(const Mapping& mapping, const openvdb::math::Transform& transform);

    /// Turns to a block.
    /// @param block  its first voxel
    /// @return lattice coordinates that its voxels, and points up to half a voxel below them, may have, as Mapping::range
    openvdb::BBoxd move_to(const openvdb::Coord& block);
    /// Whether all points of the block that lie between the first plane and the last are in the lattice's own cells, and
    /// shift() can tell where they are moved to.
    bool interior() const { return interior_; }
    /// Moves a row of an interior block, all its voxels by as much.
    /// @param offset  added to each voxel where it is located, as for locate
    /// @param by      vertices along u and v
    /// @param out     as moved() says
    /// @return bit z: voxel z lies in the lattice
    unsigned shift(const openvdb::Coord& first, const openvdb::Vec3d& offset, const openvdb::Vec2d& by, Positions& out) const;
    /// A box around the voxels that are reached from the block by so many vertices along u and v.
    openvdb::CoordBBox reach(const openvdb::Vec2d& least, const openvdb::Vec2d& most) const;
    /// Finds the places of a row of the block.
    /// @param first   its first voxel
    /// @param offset  added to each voxel: that many voxels, each 0 or -1/2
    void locate(const openvdb::Coord& first, const openvdb::Vec3d& offset, Row& row) const;
    /// Marks the voxels of a row that lie in several cells, and the lowest slab that holds each.
    /// @return bit z: voxel z lies in two cells or more
    unsigned locate_shared(const openvdb::Coord& first, std::array<int, 8>& lowest) const;

    /// Index coordinates of the voxel position `p`, which stands at `place`, moved by `g(place + by) - g(place)`. By the
    /// closed form that of `g(place + by)`, as in the paper.
    /// @param by  vertices along u and v
    openvdb::Vec3d moved(const openvdb::Vec3d& p, const Place& place, const openvdb::Vec2d& by) const {
        if (by_tables_) return p + by.x() * place.u + by.y() * place.v;
        const openvdb::Vec3d source(place.at.x() + by.x(), place.at.y() + by.y(), place.at.z());
        const auto at_source = transform_.worldToIndex(mapping_.position(source));
        return mapping_.closed_form() ? at_source : p + at_source - transform_.worldToIndex(mapping_.position(place.at));
    }

private:
    /// A slab seen from the grid's index space.
    struct Table {
        openvdb::Vec3d side;                      ///< gradient of the lower divider's side
        std::array<Slab::Products, 3> gradients;  ///< of the products along x, y and z
        openvdb::Vec3d u, du, v, dv;              ///< the steps
    };
    /// A slab that meets the block, with its values at the block's first voxel.
    struct Candidate {
        int slab;
        double low, high;  ///< sides of the dividers
        Slab::Products products;
    };
    /// Calls `visit(candidate, hits)` for the candidates in rising order, with the voxels of a row between its
    /// dividers, until it returns false.
    template <class Visit>
    void each_hit(const openvdb::Vec3d& from, Visit&& visit) const;
    /// A candidate's products at a point. @param from  the block's first voxel, voxels
    Slab::Products at(const openvdb::Vec3d& from, const Candidate& candidate) const;
    /// A row of voxels between the dividers of slabs.
    struct Entered {
        unsigned once, twice;                   ///< bit z: voxel z lies in a slab, and in several
        std::array<const Candidate*, 8> in;     ///< the lowest
        std::array<double, 8> c;                ///< there
        std::array<const double*, 8> products;  ///< of the row's first voxel there
        std::array<Slab::Products, 8> kept;
    };
    void enter(const openvdb::Vec3d& from, Entered& row) const;

    const Mapping& mapping_;
    const openvdb::math::Transform& transform_;
    std::shared_ptr<const std::vector<Table>> tables_;  ///< per slab, and one more for the last divider; none in a straight box
    bool by_tables_ = false;                            ///< whether places are found by them
    openvdb::Coord block_;
    bool interior_ = false;
    openvdb::BBoxd range_;
    std::vector<int> slabs_;
    std::vector<Candidate> candidates_;
};

}  // namespace fluidcarve
