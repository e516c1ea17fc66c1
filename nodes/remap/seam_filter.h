#pragma once

#include "graph/types/node_type.h"
#include "nodes/field/filter.h"
#include "nodes/seams/carve_map.h"

namespace fluidcarve {

/// Smooths what stands along the seams of a carved volume (paper 5.1.2; METHOD 5): active voxels in, or on the border of,
/// cells whose corners are displaced differently take the value that the filter gives there, all others keep theirs bit
/// for bit. States stay. Each component of a staggered grid is looked up at its face; in aligned boxes, at its voxel.
/// Grids of whole numbers, booleans and masks, and those that can't be carved, pass as they are.
/// @param volume  carved by `map`
/// @param mode    as field.filter. Inactive voxels count with the value that they hold
/// @param width   voxels from the middle of the cube to its sides, >= 1
/// @throws Failure naming the grid and voxel if a value that is not finite lies within the filter's reach of a seam
Volume seam_filtered(const Volume& volume, const Lattice& lattice, const CarveMap& map, FilterMode mode, int width);

/// `filter.seam {source, lattice, seams, count, filter, width}`.
NodeType filter_seam();

}  // namespace fluidcarve
