#pragma once

#include "nodes/lattice/resample.h"

#include <vector>

namespace fluidcarve {

/// The unit directions `w` of planes through resampled points.
/// @param to_next  as the paper has it: each points at the next one, the last of an open rig as the one before; else
///   halfway between the chords before and after
/// @throws Failure where two chords cancel
std::vector<openvdb::Vec3d> plane_directions(const Resampled& line, bool closed, bool to_next);

/// The unit directions `v` of those planes, orthogonal to `w` and free of twist: carried from plane to plane by double
/// reflection (Wang et al. 2008, "Computation of rotation minimizing frames"). A closed rig brings the first one back
/// turned; that angle is spread evenly over all planes.
/// @param up  made orthogonal, it is `v` of the first plane
/// @throws Failure if it runs along the path there
std::vector<openvdb::Vec3d> untwisted(const Resampled& line, const std::vector<openvdb::Vec3d>& w, bool closed, const openvdb::Vec3d& up);

}  // namespace fluidcarve
