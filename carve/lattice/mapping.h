#pragma once

#include "carve/lattice/slabs.h"
#include "carve/lattice/snap.h"

#include <array>
#include <memory>
#include <optional>

namespace fluidcarve {

/// Maps world positions to lattice index coordinates and back: `f` and `g` of METHOD 1 and METHOD
/// 3. All code uses this class for both. `g` is trilinear in a cell's vertices, and `f` is its
/// true inverse. In a straight box both are affine. Other lattices are mapped slab by slab
/// (slabs.h), and may use the paper's closed form for `f`. In a closed lattice `w` is cyclic: `w`
/// and `w + K` are the same. So are `v` and `v + J` around a rig, where `g` runs along arcs
/// between vertices, not along chords.
class Mapping {
public:
    /// @param extent  vertices per dimension that count as inside: the lattice's shape, or more
    ///   where insertions extend it along u and v; in a straight box along w, too
    /// @throws Failure if the lattice is no straight box and has fewer than 2 planes (3 if closed)
    explicit Mapping(const Lattice& lattice);
    Mapping(const Lattice& lattice, const std::array<int, 3>& extent);

    /// `f`: lattice index coordinates of a world position, snapped. Each lies within [0, extent -
    /// 1], `w` of a closed lattice within [0, K), `v` around a rig within [0, J). Nothing outside
    /// the lattice.
    std::optional<openvdb::Vec3d> locate(const openvdb::Vec3d& world) const;
    /// `g`: world position of lattice index coordinates. Continues straight beyond rims and open
    /// ends.
    openvdb::Vec3d position(const openvdb::Vec3d& at) const {
        return slabs_ ? slabs_->position(at)
                      : origin_ + at.x() * step_[0] + at.y() * step_[1] + at.z() * step_[2];
    }

    /// Box around the lattice coordinates of all points of a world box, not clipped to the extent
    /// along u and v. Empty if no slab holds any of the points (Slabs::candidates).
    openvdb::BBoxd range(const openvdb::BBoxd& world) const;
    /// World box around all points with lattice coordinates in `range`.
    openvdb::BBoxd world_box(const openvdb::BBoxd& range) const;

    const std::array<int, 3>& extent() const { return extent_; }
    /// Whether `f` is the paper's closed form, which is not the inverse of `g`.
    bool closed_form() const { return slabs_ && slabs_->closed_form(); }
    /// Null in a straight box.
    const Slabs* slabs() const { return slabs_.get(); }

    /// Lattice index coordinates in a straight box, also beyond it, not snapped.
    openvdb::Vec3d coordinates(const openvdb::Vec3d& world) const;

private:
    openvdb::Vec3d origin_;
    std::array<openvdb::Vec3d, 3> step_;  ///< from a vertex to the next along u, v, w, world units
    /// Gradients of the lattice coordinates, vertices per world unit.
    std::array<openvdb::Vec3d, 3> gradient_;
    std::array<int, 3> extent_;
    std::shared_ptr<const Slabs> slabs_;
};

}  // namespace fluidcarve
