#pragma once

#include <openvdb/Types.h>

#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// The path that the planes of a lattice follow (paper 3.1 and 3.4), in world space. An animated one is delivered per
/// frame.
struct Rig {
    /// A circle or oval: `center + cos(a) x + sin(a) y` for `a` rising from `start`, radians.
    struct Oval {
        openvdb::Vec3d center, x, y;
        double start = 0;
        openvdb::Vec3d at(double a) const;
    };

    std::vector<openvdb::Vec3d> points;  ///< joined by straight lines; of an oval: points on it, in equal steps of `a`
    bool closed = false;                 ///< the last point is followed by the first
    openvdb::Vec3d up{0, 0, 1};          ///< made orthogonal to the path, it is `v` where the path starts
    std::optional<Oval> oval;            ///< what `points` only approach
};

/// A closed rig along an oval, points included.
Rig oval_rig(const Rig::Oval& oval, const openvdb::Vec3d& up);

/// What keeps a rig from being a path, in words, or empty: fewer than 2 points, or 3 if closed; neighbouring points that
/// are the same; a point where it turns right back.
std::string rig_fault(const Rig& rig);

/// For messages: "(1, 2, 3)".
std::string text_of(const openvdb::Vec3d& position);
/// For messages: "a circle of radius 2 around (0, 0, 0)", "an open path of 3 points from (0, 0, 0) to (4, 0, 0)".
std::string text_of(const Rig& rig);

}  // namespace fluidcarve
