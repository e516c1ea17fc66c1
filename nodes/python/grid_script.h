#pragma once

#include "nodes/payloads.h"
#include "nodes/python/python_script.h"

#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

extern const char* const python_inputs_doc;

/// Checks a script whose function takes the grids of the input `inputs`.
void check_grid_script(const PythonParams& params, const std::string& function, NodeCheck& check);

/// Calls a function of grids that returns a number for each voxel.
/// @param least  smallest allowed result, or -infinity
/// @return a grid called like the function, with the voxels that are active in any input; 0 elsewhere
/// @throws Failure naming the script and the voxel, if a result is below `least` or not finite; else as SharedGrids and call_script
FloatGrid::Ptr numbers_of_script(const PythonParams& params, const std::string& function, float least,
                                 const std::vector<std::pair<std::string, Ref<AnyGrid>>>& inputs, Context& context);

/// Calls a function of grids that returns true or false for each voxel. @throws as numbers_of_script
MaskGrid::Ptr states_of_script(const PythonParams& params, const std::string& function, const std::vector<std::pair<std::string, Ref<AnyGrid>>>& inputs,
                               Context& context);

}  // namespace fluidcarve
