#pragma once

#include "nodes/preview/projection.h"
#include "nodes/seams/seams.h"

#include <array>
#include <vector>

namespace fluidcarve {

/// A straight line in a picture, in voxels to the right and up; voxel n reaches from n to n + 1.
struct PictureLine {
    std::array<double, 2> from{};
    std::array<double, 2> to{};
};

/// Whether the carved direction runs along the view rather than across it: then each seam faces the viewer, and where
/// it crosses a slice says nothing.
bool seams_face(const Lattice& lattice, Axis axis, const openvdb::math::Transform& space, View view);

/// Where seams cross a plane, at their places in the lattice before any of them is carved: the removed vertices, or half
/// a vertex behind the doubled ones, where the new ones stand. Each seam is the surface through its vertices, which goes
/// on straight for half a vertex beyond the rims of the lattice, as far as the voxels there reach.
/// @param frame  a frame number
/// @param space  of the picture and the plane, mostly that of the grid shown
/// @param plane  index coordinate along the view
/// @throws Failure as CarveMap: another lattice, another shape, or no such frame
std::vector<PictureLine> seam_lines(const Lattice& lattice, const Seams& seams, int frame, const openvdb::math::Transform& space, View view, int plane);

/// The first part of that alone: whether the seams are of the lattice and hold the frame.
/// @return the frame's place in them
/// @throws Failure
std::size_t require_seams(const Lattice& lattice, const Seams& seams, int frame);

}  // namespace fluidcarve
