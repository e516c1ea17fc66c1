#pragma once

#include "graph/pipeline.h"

namespace fluidcarve {

/// Adds notes to a pipeline about output files that its sequence does not write, such as those of
/// an earlier run.
void note_old_files(Pipeline& pipeline);

}  // namespace fluidcarve
