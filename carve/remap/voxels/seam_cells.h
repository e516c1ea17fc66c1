#pragma once

#include "carve/seam/carve_map.h"

namespace fluidcarve {

// Points are in carved lattice index coordinates. Each step's cell is looked up in the index space
// after that step; the displacements of later steps lead back there.

/// Whether a point lies along a seam: in, or on the border of, a cell of any step whose corners are
/// displaced differently.
bool along_seam(const CarveMap& map, openvdb::Vec3d at);

/// Whether some point of a box may lie along a seam.
bool may_hold_seam(const CarveMap& map, openvdb::BBoxd range);

/// Whether a carve changes a point: in any step, a corner of non-zero weight of its cell moves, or
/// a removal frees the point.
bool is_moved(const CarveMap& map, const openvdb::Vec3d& at);

}  // namespace fluidcarve
