#pragma once

#include "runtime/run/inputs.h"

namespace fluidcarve {

/// Follows through the pipeline what its readers say of where their outputs lie, and calls the
/// `foresee` of each node that the run needs. Outputs of a node without one lie where all its
/// inputs lie together. Warnings go to the report.
void foresee(const Pipeline& pipeline, const Plan& plan, const Inputs& inputs, Report& report);

}  // namespace fluidcarve
