#pragma once

#include "carve/lattice/resample.h"

#include <vector>

namespace fluidcarve {

/// Unit directions `w` of the planes through resampled points.
/// @param to_next  true: each plane faces the next point, as in the paper; the last plane of an
///   open rig faces like the one before. false: each plane faces halfway between the chords before
///   and after it
/// @return `[plane]`
/// @throws Failure where two chords cancel
std::vector<openvdb::Vec3d> plane_directions(const Resampled& line, bool closed, bool to_next);

/// Unit directions `v` of those planes, orthogonal to `w` and without twist. They are carried from
/// plane to plane by double reflection (Wang et al. 2008, "Computation of rotation minimizing
/// frames"). A closed rig brings the first direction back turned; that angle is spread evenly over
/// all planes.
/// @param up  becomes `v` of the first plane, once made orthogonal to `w`
/// @return `[plane]`
/// @throws Failure if `up` runs along the path at the first plane
std::vector<openvdb::Vec3d> untwisted(const Resampled& line, const std::vector<openvdb::Vec3d>& w,
                                      bool closed, const openvdb::Vec3d& up);

}  // namespace fluidcarve
