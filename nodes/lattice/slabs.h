#pragma once

#include "nodes/lattice/slab.h"
#include "nodes/lattice/snap.h"

#include <openvdb/math/BBox.h>

#include <algorithm>
#include <optional>
#include <vector>

namespace fluidcarve {

/// `f` and `g` of a lattice whose planes turn (METHOD 3), open or closed; what Mapping does where it is not affine.
/// A position belongs to slab `k` if it lies on or above plane k and below plane k + 1 (in a closed lattice the last
/// slab ends at plane 0). Where several slabs hold it, the lowest does, but cells of the lattice win over those by
/// which insertions extend it: that depends on nothing but the position.
class Slabs {
public:
    /// What limits a slab: the side of a plane.
    struct Divider {
        openvdb::Vec3d normal, point;
        double side(const openvdb::Vec3d& p) const { return normal.dot(p - point); }
    };
    enum class Holds { no, beyond, yes };

    /// @throws Failure if there are too few planes to bend
    Slabs(const Lattice& lattice, const std::array<int, 3>& extent);

    int size() const { return size_; }
    /// Whether positions are located by the paper's closed form.
    bool closed_form() const { return closed_form_; }
    const Slab& operator[](int k) const { return slabs_[static_cast<std::size_t>(k)]; }
    /// Slab k lies between dividers k and k + 1. The ends of an open lattice stand rim_slack beyond it.
    const Divider& divider(int k) const { return dividers_[static_cast<std::size_t>(k)]; }
    double from(int k) const { return k == 0 ? -open_slack_ : 0; }
    double to(int k) const { return k + 1 == size() ? 1 + open_slack_ : 1; }

    openvdb::Vec3d position(const openvdb::Vec3d& at) const;
    std::optional<openvdb::Vec3d> locate(const openvdb::Vec3d& world) const;
    /// Whether a box of lattice coordinates lies inside the lattice's own cells, as far as u and v go.
    bool inside(const openvdb::BBoxd& range) const {
        return range.min().x() >= 0 && range.min().y() >= 0 && range.max().x() <= last_u_ && range.max().y() <= last_v_;
    }
    /// Whether the cells of a slab, or the cells that insertions add to it, hold a solved point.
    /// @param at  becomes its lattice coordinates, snapped and within the extent, unless nothing holds it
    Holds settle(int slab, const openvdb::Vec3d& solved, openvdb::Vec3d& at) const;

    /// All slabs that may hold points of a world box, rising.
    /// @return a box around the lattice coordinates of those points, empty if there are none. Along u and v: the
    ///   coordinates in the lower plane of each slab, affine, and what they may differ by within the slab: that is
    ///   linear in u and v, and so greatest in a corner; not limited to the extent. Along w: whole slabs; in a closed lattice the shortest way
    ///   around, which may go on past K.
    openvdb::BBoxd candidates(const openvdb::BBoxd& world, std::vector<int>& slabs) const;
    /// Around the corners of the box in all planes between its ends: between those all is straight.
    openvdb::BBoxd world_box(const openvdb::BBoxd& range) const;

private:
    struct Bounds {
        openvdb::BBoxd box;                     ///< of the vertices, world units
        openvdb::Vec3d gradient_u, gradient_v;  ///< of the coordinates in the lower plane
        double error_u, error_v;                ///< of those within the slab, vertices
    };
    Bounds bounds_of(int k) const;
    /// Calls `visit(k)`, rising, for the slabs whose vertices' box meets a world box, until it returns false.
    template <class Visit>
    void each(const openvdb::BBoxd& world, Visit&& visit) const;

    bool closed_, closed_form_;
    int size_;
    double open_slack_, spacing_;
    double last_u_, last_v_;        ///< last vertices of the lattice
    double end_u_, end_v_, end_w_;  ///< and of the extent; along w, the end of the last slab
    std::vector<Slab> slabs_;
    std::vector<Divider> dividers_;
    std::vector<Bounds> bounds_;
    std::vector<openvdb::BBoxd> groups_;  ///< around the boxes of sixteen slabs each
};

inline Slabs::Holds Slabs::settle(int slab, const openvdb::Vec3d& solved, openvdb::Vec3d& at) const {
    const auto inside = [](double x, double end) { return x >= -rim_slack && x <= end + rim_slack; };
    if (!inside(solved.x(), end_u_) || !inside(solved.y(), end_v_)) return Holds::no;
    const double w = std::max(0.0, snapped(slab + solved.z()));
    at = {std::clamp(snapped(solved.x()), 0.0, end_u_), std::clamp(snapped(solved.y()), 0.0, end_v_), w < end_w_ ? w : closed_ ? 0 : end_w_};
    return at.x() <= last_u_ && at.y() <= last_v_ ? Holds::yes : Holds::beyond;
}

}  // namespace fluidcarve
