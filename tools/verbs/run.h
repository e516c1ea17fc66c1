#pragma once

#include "graph/document.h"
#include "graph/pipeline.h"
#include "tools/verbs/arguments.h"

namespace fluidcarve {

/// Runs a checked pipeline as the arguments say, until it ends or the user interrupts it.
/// @param document  from which the pipeline was built
/// @return the exit code
int run_built(Pipeline pipeline, const Document& document, RunArguments& arguments,
              const Registry& registry);

}  // namespace fluidcarve
