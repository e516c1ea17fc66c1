#pragma once

#include "nodes/expression/expression.h"

#include <cstdint>
#include <string>
#include <vector>

namespace fluidcarve {

/// Runs a program for every voxel that is active in any of its inputs. Beyond its own active voxels an input has the value that
/// it holds there (its background, mostly). What is a tile in all inputs becomes a tile, unless the program asks where it is.
/// @param inputs  float, vector and mask grids of one transform, by name; a mask counts as 1 and 0, a staggered vector grid is
///                collocated first
/// @param place  of a place in the program, for messages
/// @param least  the smallest value that is allowed, or -infinity
/// @param budget  bytes that the result may take
/// @return a grid called `output`, background 0, with the transform of the first input
/// @throws Failure naming an input that is of another type than the program reads, or two whose transforms differ; or the voxel
///         where a result is below `least`, or not finite
FloatGrid::Ptr evaluated(const ExpressionModule& module, const CompiledExpression& program, const std::vector<std::pair<std::string, Ref<AnyGrid>>>& inputs,
                         const std::string& output, float least, std::uint64_t budget, const std::function<std::string(int line, int column)>& place);

}  // namespace fluidcarve
