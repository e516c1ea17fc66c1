#pragma once

#include "carve/seam/seams.h"
#include "nodes/preview/projection.h"

#include <array>
#include <vector>

namespace fluidcarve {

/// A straight line in a picture, from (right, up) to (right, up) in voxels; voxel n reaches from n
/// to n + 1.
struct PictureLine {
    std::array<double, 2> from{};
    std::array<double, 2> to{};
};

/// Whether the carved direction runs along the view rather than across it. Seams then face the
/// viewer, and their lines in a slice would be meaningless.
bool seams_face(const Lattice& lattice, Axis axis, const openvdb::math::Transform& space,
                View view);

/// The lines in which seams cross a plane, at their places in the uncarved lattice: at removed
/// vertices, or half a vertex after doubled vertices, where new ones are inserted. A seam is the
/// surface through its vertices, extended straight by half a vertex beyond the rims of the lattice,
/// where the voxels there end. Of a warp, the surfaces where it moves content by a whole number of
/// vertices and a half: they lie close together where it squeezes or widens much.
/// @param frame  frame number
/// @param space  transform of the picture and the plane, mostly that of the grid shown
/// @param plane  index coordinate along the view
/// @throws Failure as CarveMap: another lattice, another shape, or no such frame
std::vector<PictureLine> seam_lines(const Lattice& lattice, const Seams& seams, int frame,
                                    const openvdb::math::Transform& space, View view, int plane);

/// Checks that seams belong to a lattice and have a frame.
/// @param frame  frame number
/// @return index of the frame in `seams.frames`
/// @throws Failure as seam_lines
std::size_t require_seams(const Lattice& lattice, const Seams& seams, int frame);

}  // namespace fluidcarve
