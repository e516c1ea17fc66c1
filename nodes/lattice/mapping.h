#pragma once

#include "nodes/lattice/slabs.h"
#include "nodes/lattice/snap.h"

#include <memory>

namespace fluidcarve {

/// World to lattice index coordinates and back: `f` and `g` of METHOD 1 and 3, the one place that knows how. `g` is
/// trilinear in a cell's vertices, `f` its true inverse. In straight boxes both are affine, in other lattices they go
/// slab by slab (slabs.h); there a lattice may ask for the paper's closed form instead. In a closed lattice `w` is a
/// coordinate of a ring: `w` and `w + K` are the same.
class Mapping {
public:
    static constexpr double snap = snap_width;
    static constexpr double slack = rim_slack;

    /// @param extent  vertices per dimension that count as inside, where insertions extend the lattice beyond its
    ///   shape; only a straight box can be extended along w
    /// @throws Failure if the lattice is no straight box and has too few planes to be anything else
    explicit Mapping(const Lattice& lattice);
    Mapping(const Lattice& lattice, const std::array<int, 3>& extent);

    /// `f`: lattice index coordinates of a world position, snapped, each within [0, extent - 1], `w` of a closed
    /// lattice within [0, K); nothing outside.
    std::optional<openvdb::Vec3d> locate(const openvdb::Vec3d& world) const;
    /// `g`: the world position. Goes on straight beyond rims and open ends.
    openvdb::Vec3d position(const openvdb::Vec3d& at) const {
        return slabs_ ? slabs_->position(at) : origin_ + at.x() * step_[0] + at.y() * step_[1] + at.z() * step_[2];
    }

    /// A box around the lattice coordinates of all points of a world box, along u and v not limited to the extent; empty
    /// if slabs hold none of them (Slabs::candidates).
    openvdb::BBoxd range(const openvdb::BBoxd& world) const;
    /// A world box around all points with lattice coordinates in `range`.
    openvdb::BBoxd world_box(const openvdb::BBoxd& range) const;

    const std::array<int, 3>& extent() const { return extent_; }
    /// Whether `f` is the paper's closed form, no inverse of `g`.
    bool closed_form() const { return slabs_ && slabs_->closed_form(); }
    /// Nothing in a straight box.
    const Slabs* slabs() const { return slabs_.get(); }

private:
    openvdb::Vec3d coordinates(const openvdb::Vec3d& world) const;
    openvdb::Vec3d origin_;
    std::array<openvdb::Vec3d, 3> step_;      ///< from a vertex to the next, world units
    std::array<openvdb::Vec3d, 3> gradient_;  ///< of the lattice coordinates
    std::array<int, 3> extent_;
    std::shared_ptr<const Slabs> slabs_;
};

}  // namespace fluidcarve
