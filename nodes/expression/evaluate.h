#pragma once

#include "nodes/expression/expression.h"

#include <cstdint>
#include <string>
#include <vector>

namespace fluidcarve {

/// Runs a program for every voxel that is active in any input. Inactive voxels of an input have
/// their stored value, mostly the background. A tile in all inputs becomes a tile of the result,
/// unless the program uses the voxel's position.
/// @param inputs  name and grid: float, vector or mask, all with the same transform. A mask reads
///   as 1 and 0, a staggered vector grid is collocated first
/// @param least   smallest allowed result, or -infinity
/// @param budget  limit of the result's size, bytes
/// @param place   converts a place in the program to text, for messages
/// @return a grid called `output`, background 0, with the transform of the first input
/// @throws Failure naming an input of another type than the program reads, two inputs with
///   different transforms, or a voxel whose result is below `least` or not finite
FloatGrid::Ptr evaluated(const ExpressionModule& module, const CompiledExpression& program,
                         const std::vector<std::pair<std::string, Ref<AnyGrid>>>& inputs,
                         const std::string& output, float least, std::uint64_t budget,
                         const std::function<std::string(int line, int column)>& place);

}  // namespace fluidcarve
