#pragma once

#include "carve/base/region.h"

#include <openvdb/Types.h>

#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// The path that the planes of a lattice follow (paper 3.1 and 3.4), in world space. A moving rig
/// is one per frame.
struct Rig {
    /// A circle or oval: `center + cos(a) x + sin(a) y`, where the angle `a` rises from `start`;
    /// radians.
    struct Oval {
        openvdb::Vec3d center, x, y;
        double start = 0;
        openvdb::Vec3d at(double a) const;
    };

    std::vector<openvdb::Vec3d> points;  ///< joined by straight lines; of an oval: points on it, in
                                         ///< equal steps of `a`; world units
    bool closed = false;                 ///< the rig returns from its last point to its first
    openvdb::Vec3d up{0, 0,
                      1};  ///< becomes `v` where the path starts, once made orthogonal to the path
    std::optional<Oval> oval;  ///< the exact curve, which `points` only approximate
};

/// A closed rig along an oval, with its points.
Rig oval_rig(const Rig::Oval& oval, const openvdb::Vec3d& up);

/// Why a rig is not a valid path, in words; empty if it is valid. Faults: fewer than 2 points (3
/// if closed); equal neighbouring points; a point where the rig turns straight back.
std::string rig_fault(const Rig& rig);

/// The region of a rig: a box for each segment between points, or, if there are many, for a few
/// consecutive segments.
Region region_of(const Rig& rig);

/// For messages: "(1, 2, 3)".
std::string to_text(const openvdb::Vec3d& position);
/// For messages: "a circle of radius 2 around (0, 0, 0)", "an open path of 3 points from (0, 0, 0)
/// to (4, 0, 0)".
std::string to_text(const Rig& rig);

}  // namespace fluidcarve
