#pragma once

#include "nodes/preview/canvas.h"
#include "tools/compare/file_comparer.h"

#include <openvdb/openvdb.h>

#include <string>

namespace fluidcarve {

/// Two grids of one type and name, and the place where they differ most.
struct DrawnDifference {
    openvdb::GridBase::ConstPtr a, b;
    FilePair paths;
    WorstPlace worst;  ///< an index of two or three numbers
    std::string title;
};

/// Draws slices of A, of B and of B - A side by side, a row for each axis along which the grids are
/// more than one voxel thick in both directions of the picture. Every slice goes through the worst
/// place, which is framed. A and B share a scale of colours; the other, from blue to orange, is
/// symmetric around 0. Of vectors, lengths are drawn, and the length of the difference.
/// @throws Failure if the grids hold no values that can be drawn
Canvas draw_difference(const DrawnDifference& shown);

}  // namespace fluidcarve
