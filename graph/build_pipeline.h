#pragma once

#include "graph/document.h"
#include "graph/pipeline.h"
#include "graph/types/registry.h"

namespace fluidcarve {

/// Checks a document against the registry. Opens no data files.
/// @return the pipeline; not usable if problems were added
Pipeline build_pipeline(const Document& document, const Registry& registry, Problems& problems);

}  // namespace fluidcarve
