#pragma once

#include "carve/lattice/polar.h"
#include "carve/lattice/slab.h"
#include "carve/lattice/snap.h"

#include <openvdb/math/BBox.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace fluidcarve {

/// `f` and `g` of a lattice whose planes turn, or that goes around its rig (METHOD 3), open or
/// closed. Mapping uses it for all lattices but straight boxes. A position belongs to slab `k` if
/// it lies on or above plane k and below plane k + 1; the last slab of a closed lattice ends at
/// plane 0. If several slabs hold a position, the lowest one wins; but the lattice's own cells win
/// over cells that insertions add. So the result depends on the position alone.
class Slabs {
public:
    /// A plane that bounds a slab.
    struct Divider {
        openvdb::Vec3d normal, point;
        double side(const openvdb::Vec3d& p) const { return normal.dot(p - point); }
    };
    /// Whether a slab holds a point: no; in cells that insertions add; in the lattice's own cells.
    enum class Holds { no, beyond, yes };

    /// @throws Failure if there are fewer than 2 planes (3 if closed)
    Slabs(const Lattice& lattice, const std::array<int, 3>& extent);

    int size() const { return size_; }
    /// Whether positions are located by the paper's closed form.
    bool closed_form() const { return closed_form_; }
    /// The coordinates around the rig; nothing if the lattice does not go around it.
    const std::optional<Polar>& polar() const { return polar_; }
    const Slab& operator[](int k) const { return slabs_[static_cast<std::size_t>(k)]; }
    /// Slab k lies between dividers k and k + 1. The first and last dividers of an open lattice
    /// stand rim_slack beyond its ends.
    const Divider& divider(int k) const { return dividers_[static_cast<std::size_t>(k)]; }
    /// Bounds of the coordinate `c` in slab k: 0 and 1, or rim_slack beyond at an open end.
    double from(int k) const { return k == 0 ? -open_slack_ : 0; }
    double to(int k) const { return k + 1 == size() ? 1 + open_slack_ : 1; }

    openvdb::Vec3d position(const openvdb::Vec3d& at) const;
    std::optional<openvdb::Vec3d> locate(const openvdb::Vec3d& world) const;
    /// Whether a box of lattice coordinates lies within the lattice's own cells along u and v.
    /// Always false around a rig.
    bool inside(const openvdb::BBoxd& range) const {
        return !polar_ && range.min().x() >= 0 && range.min().y() >= 0 &&
               range.max().x() <= last_u_ && range.max().y() <= last_v_;
    }
    /// Whether a slab holds a point.
    /// @param solved  coordinates of the point in the slab, as by Slab::at; around a rig `(x, y,
    ///   c)`
    /// @param at      becomes its lattice coordinates, snapped and within the extent; unchanged if
    ///   the slab does not hold it
    Holds settle(int slab, const openvdb::Vec3d& solved, openvdb::Vec3d& at) const;

    /// Finds all slabs that may hold points of a world box.
    /// @param slabs  becomes their indices, rising
    /// @return box around the lattice coordinates of those points; empty if there are none. Along
    ///   u and v it is not clipped to the extent: it holds the coordinates in the lower plane of
    ///   each slab, which are affine, widened by their largest error within the slab. The error is
    ///   linear in u and v, so it is largest in a corner. Along w it holds whole slabs; in a
    ///   closed lattice the shortest arc of the ring, which may continue past K. Around a rig, v
    ///   is treated like w of a closed lattice, and u has exact bounds
    openvdb::BBoxd candidates(const openvdb::BBoxd& world, std::vector<int>& slabs) const;
    /// World box around all points with lattice coordinates in `range`. It encloses the corners of
    /// `range` at both ends and in all planes between: between planes the lattice is straight.
    /// Around a rig, it encloses the corners of the squares that hold the range.
    openvdb::BBoxd world_box(const openvdb::BBoxd& range) const;
    /// Bounds of the coordinates `(x, y)` of all points in the extent: those of the lattice's rims.
    /// Around a rig, the square that holds them.
    openvdb::BBoxd across() const;

private:
    /// What candidates() needs to know of a slab.
    struct Bounds {
        openvdb::BBoxd box;  ///< around the slab's vertices, world units
        /// Of the coordinates u and v in the lower plane, vertices per world unit.
        openvdb::Vec3d gradient_u, gradient_v;
        double error_u, error_v;  ///< largest error of those coordinates within the slab, vertices
    };
    Bounds bounds_of(int k) const;
    /// Whether a box of coordinates `(x, y)` misses the extent.
    bool beside(const openvdb::BBoxd& box) const;
    /// Box around the coordinates `(u, v)` of a box of `(x, y)`; w stays.
    openvdb::BBoxd around(const openvdb::BBoxd& box) const;
    /// Whether a coordinate lies in the extent, up to its last vertex.
    static bool within(double x, double end) { return x >= -rim_slack && x <= end + rim_slack; }
    /// settle() around a rig.
    Holds settle_around(const openvdb::Vec3d& solved, double w, openvdb::Vec3d& at) const;
    /// Calls `visit(k)`, k rising, for the slabs whose box meets a world box, until it returns
    /// false.
    template <class Visit>
    void each(const openvdb::BBoxd& world, Visit&& visit) const;

    bool closed_, closed_form_;
    std::optional<Polar> polar_;
    int size_;
    double open_slack_, spacing_;
    double last_u_, last_v_;  ///< index of the lattice's last vertex
    double end_u_, end_v_;    ///< index of the extent's last vertex
    double end_w_;            ///< end of the last slab, along w
    std::vector<Slab> slabs_;
    std::vector<Divider> dividers_;
    std::vector<Bounds> bounds_;
    std::vector<openvdb::BBoxd> groups_;  ///< each around the boxes of sixteen slabs
};

inline Slabs::Holds Slabs::settle(int slab, const openvdb::Vec3d& solved,
                                  openvdb::Vec3d& at) const {
    const double along = std::max(0.0, snapped(slab + solved.z())), w = along < end_w_ ? along
                                                                        : closed_      ? 0
                                                                                       : end_w_;
    if (polar_) return settle_around(solved, w, at);
    if (!within(solved.x(), end_u_) || !within(solved.y(), end_v_)) return Holds::no;
    at = {std::clamp(snapped(solved.x()), 0.0, end_u_),
          std::clamp(snapped(solved.y()), 0.0, end_v_), w};
    return at.x() <= last_u_ && at.y() <= last_v_ ? Holds::yes : Holds::beyond;
}

}  // namespace fluidcarve
