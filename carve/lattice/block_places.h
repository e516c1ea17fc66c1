#pragma once

#include "carve/lattice/mapping.h"

#include <openvdb/math/Coord.h>
#include <openvdb/math/Transform.h>

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

namespace fluidcarve {

/// Finds where the voxels of a grid lie in a lattice, one 8^3 block at a time. The result is that
/// of Mapping::locate, but faster: the slabs that meet the block are looked up once, and all
/// products are affine along a row of voxels.
class BlockPlaces {
public:
    /// The place of a voxel in the lattice.
    struct Place {
        openvdb::Vec3d at;  ///< lattice index coordinates
        /// Steps to the next vertex along u and v, voxels. Not set in a straight box or with the
        /// closed form. Around a rig, v is 0: nothing moves along it.
        openvdb::Vec3d u, v;
    };
    /// Eight voxels along z.
    struct Row {
        /// Bit z is set if voxel z lies in the lattice; only then places[z] is set.
        unsigned inside = 0;
        std::array<Place, 8> places;
    };
    /// Index coordinates of eight points.
    struct Positions {
        /// `[axis][point]`
        std::array<std::array<double, 8>, 3> xyz;
        openvdb::Vec3d at(std::size_t n) const { return {xyz[0][n], xyz[1][n], xyz[2][n]}; }
        void set(std::size_t n, const openvdb::Vec3d& to) {
            for (std::size_t axis = 0; axis < 3; ++axis) xyz[axis][n] = to[static_cast<int>(axis)];
        }
    };

    /// @param mapping, transform  must outlive this object and its copies; copies share all data
    ///   that does not depend on a block
    BlockPlaces(const Mapping& mapping, const openvdb::math::Transform& transform);

    /// Moves to a block.
    /// @param block  the block's first voxel
    /// @return box around the lattice coordinates of the block's voxels and of points up to half a
    ///   voxel below them, as Mapping::range
    openvdb::BBoxd move_to(const openvdb::Coord& block);
    /// Whether shift() may be called: all points of the block between the first and the last plane
    /// lie in the lattice's own cells, places are found by tables, and the lattice does not go
    /// around its rig.
    bool interior() const { return interior_; }
    /// Moves all voxels of a row of an interior block by the same number of vertices.
    /// @param first   first voxel of the row
    /// @param offset  added to each voxel before it is located, voxels, as for locate()
    /// @param by      displacement, vertices; 0 along w
    /// @param out     becomes the moved voxels, as by moved()
    /// @return bit z is set if voxel z lies in the lattice
    unsigned shift(const openvdb::Coord& first, const openvdb::Vec3d& offset,
                   const openvdb::Vec3d& by, Positions& out);
    /// Box around all voxels that displacements of the block's voxels can reach.
    /// @param least, most  bounds of the displacements, vertices
    openvdb::CoordBBox reach(const openvdb::Vec3d& least, const openvdb::Vec3d& most) const;
    /// Finds the places of a row of the block.
    /// @param first   first voxel of the row
    /// @param offset  added to each voxel before it is located, voxels; each component is 0 or -1/2
    void locate(const openvdb::Coord& first, const openvdb::Vec3d& offset, Row& row);
    /// Finds the voxels of a row that lie in several cells.
    /// @param first   first voxel of the row
    /// @param lowest  `[z]` becomes the lowest slab that holds voxel z, if several do
    /// @return bit z is set if voxel z lies in two cells or more
    unsigned locate_shared(const openvdb::Coord& first, std::array<int, 8>& lowest) const;

    /// Moves the position `p` to `p + g(place + by) - g(place)`; with the closed form to `g(place +
    /// by)`, as in the paper.
    /// @param p      index coordinates
    /// @param place  of `p` in the lattice
    /// @param by     displacement, vertices
    /// @return index coordinates
    openvdb::Vec3d moved(const openvdb::Vec3d& p, const Place& place,
                         const openvdb::Vec3d& by) const {
        if (by_tables_ && by.z() == 0) return p + by.x() * place.u + by.y() * place.v;
        const auto at_source = transform_.worldToIndex(mapping_.position(place.at + by));
        return mapping_.closed_form()
                   ? at_source
                   : p + at_source - transform_.worldToIndex(mapping_.position(place.at));
    }

private:
    /// A slab's vectors in the grid's index space.
    struct Table {
        openvdb::Vec3d side;  ///< gradient of Divider::side of the lower divider
        std::array<Slab::Products, 3> gradients;  ///< of the slab's products along x, y and z
        openvdb::Vec3d u, du, v, dv;  ///< steps along u and v at the lower plane, and their change
                                      ///< to the upper one, voxels
    };
    /// A slab that meets the block, with its values at the block's first voxel.
    struct Candidate {
        int slab;
        double low, high;  ///< Divider::side of the lower and the upper divider
        Slab::Products products;
    };
    /// Calls `visit(candidate, hits)` for the candidates in rising order until `visit` returns
    /// false. Bit z of `hits` is set if voxel z of the row lies between the candidate's dividers.
    /// @param from  position of the row's first voxel from the block's first voxel, voxels
    template <class Visit>
    void each_hit(const openvdb::Vec3d& from, Visit&& visit) const;
    /// A candidate's products at a point.
    /// @param from  position of the point from the block's first voxel, voxels
    Slab::Products at(const openvdb::Vec3d& from, const Candidate& candidate) const;
    /// The voxels of a row that lie between the dividers of a slab. `[z]` is set if voxel z does.
    struct Entered {
        bool known = false;    ///< whether the members up to c are set
        unsigned once, twice;  ///< bit z is set if voxel z lies in one slab or more, in two or more
        /// Place among the candidates of the lowest slab that holds voxel z.
        std::array<std::size_t, 8> in;
        std::array<double, 8> c;  ///< coordinate of voxel z between that slab's planes, 0..1
        bool levelled = false;    ///< whether the rest is set
        std::array<Slab::Level, 8> levels;
        std::array<openvdb::Vec3d, 8> u, v;  ///< steps along u and v at c, voxels
    };
    /// Finds the lowest slab of each voxel of a row, and the voxel's coordinate between its planes.
    /// Rows that differ only along even_ share the result.
    /// @param from  position of the row's first voxel from the block's first voxel, voxels
    Entered& enter(const openvdb::Vec3d& from);
    void find(const openvdb::Vec3d& from, Entered& row) const;
    void find_levels(Entered& row) const;
    /// Finds voxels in the lowest slabs that they entered.
    /// @return bit z is set if a higher slab may hold voxel z in the lattice's own cells
    unsigned locate_lowest(const openvdb::Vec3d& from, const Entered& entered, Row& row) const;
    /// Finds voxels in the slabs above.
    /// @param open  bit z is set for the voxels that are sought
    void locate_higher(const openvdb::Vec3d& from, const Entered& entered, unsigned open,
                       Row& row) const;
    /// Enters a voxel's place in the row, if the slab holds it.
    /// @param solved  the place that the slab gives
    /// @param u, v    steps along u and v there, voxels
    /// @return whether the slab holds it in the lattice's own cells
    bool settle(int slab, const openvdb::Vec3d& solved, const openvdb::Vec3d& u,
                const openvdb::Vec3d& v, std::size_t z, Row& row) const;

    const Mapping& mapping_;
    const openvdb::math::Transform& transform_;
    /// `[slab]`, and one more for the last divider; null in a straight box.
    std::shared_ptr<const std::vector<Table>> tables_;
    bool by_tables_ = false;  ///< whether places are found by tables_: not in a straight box or
                              ///< with the closed form
    /// The index axis, x or y, that is parallel to all planes, if any.
    std::optional<int> even_;
    openvdb::Coord block_;
    bool interior_ = false;
    openvdb::BBoxd range_;
    std::vector<int> slabs_;
    std::vector<Candidate> candidates_;
    std::array<Entered, 32> entered_;  ///< index: 2 (2 a + 1), with the row's position `a` across
                                       ///< even_, in voxels; plus 1 if the row begins half a voxel
                                       ///< below along z
};

}  // namespace fluidcarve
