#pragma once

#include "graph/document.h"
#include "graph/pipeline.h"
#include "graph/types/registry.h"

namespace fluidcarve {

/// Sets the provenance that the files of each writer state: the program's version, the pipeline,
/// the values of the writer and of the nodes upstream, and the command that makes the files again.
/// It changes only with these: not with output paths, comments, frames to deliver, threads or
/// folders. Absolute paths are cut to the file's name. Does nothing with `provenance: false`.
/// @param pipeline  that of the document; must have no problems
void state_provenance(Pipeline& pipeline, const Document& document, const Registry& registry);

}  // namespace fluidcarve
