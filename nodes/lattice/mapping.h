#pragma once

#include "nodes/lattice/lattice.h"

#include <openvdb/math/BBox.h>

#include <optional>

namespace fluidcarve {

/// World to lattice index coordinates and back: `f` and `g` of METHOD 1 and 3, the one place that knows how.
/// Straight boxes only: both are affine.
class Mapping {
public:
    /// Coordinates this near to a whole number are that number.
    static constexpr double snap = 1e-5;
    /// Points this far beyond a rim still count as inside, and are moved onto the rim.
    static constexpr double slack = 1e-4;

    /// @param extent  vertices per dimension that count as inside, where insertions extend the lattice beyond its shape
    /// @throws Failure if the lattice is no straight box
    explicit Mapping(const Lattice& lattice);
    Mapping(const Lattice& lattice, const std::array<int, 3>& extent);

    /// `f`: lattice index coordinates of a world position, snapped, each within [0, extent - 1]; nothing outside.
    std::optional<openvdb::Vec3d> locate(const openvdb::Vec3d& world) const;
    /// `g`: the world position.
    openvdb::Vec3d position(const openvdb::Vec3d& at) const { return origin_ + at.x() * step_[0] + at.y() * step_[1] + at.z() * step_[2]; }

    /// Lattice coordinates that points of a world box may have, not limited to the extent.
    openvdb::BBoxd range(const openvdb::BBoxd& world) const;
    /// World box around all points with lattice coordinates in `range`.
    openvdb::BBoxd world_box(const openvdb::BBoxd& range) const;

    const std::array<int, 3>& extent() const { return extent_; }

private:
    openvdb::Vec3d coordinates(const openvdb::Vec3d& world) const;
    openvdb::Vec3d origin_;
    std::array<openvdb::Vec3d, 3> step_;      ///< from a vertex to the next, world units
    std::array<openvdb::Vec3d, 3> gradient_;  ///< of the lattice coordinates
    std::array<int, 3> extent_;
};

/// The whole number within Mapping::snap of `x`, else `x`.
double snapped(double x);
openvdb::Vec3d snapped(const openvdb::Vec3d& x);

}  // namespace fluidcarve
