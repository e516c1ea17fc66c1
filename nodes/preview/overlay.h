#pragma once

#include "carve/rig/rig.h"
#include "nodes/preview/seam_lines.h"

#include <array>
#include <vector>

namespace fluidcarve {

/// The lines of a lattice, projected along the view: the outlines of about 16 of its planes, and
/// the four lines through their corners. In a closed lattice these close.
/// @param space  transform of the picture, mostly that of the grid shown
std::vector<PictureLine> lattice_lines(const Lattice& lattice,
                                       const openvdb::math::Transform& space, View view);

/// The path of a rig, projected along the view. @param space  as in lattice_lines
std::vector<PictureLine> rig_lines(const Rig& rig, const openvdb::math::Transform& space,
                                   View view);

/// A direction as seen in a picture, of length 1; 0 if the transform has none.
struct SeenDirection {
    double right = 0;
    double up = 0;
    double towards = 0;  ///< towards the viewer
};

/// The directions of the world's axes x, y and z in a picture.
/// @param space  transform of the picture
/// @param at     index coordinates of the place, where the transform is not the same everywhere
std::array<SeenDirection, 3> world_axes(const openvdb::math::Transform& space,
                                        const openvdb::Vec3d& at, View view);

}  // namespace fluidcarve
