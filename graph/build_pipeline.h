#pragma once

#include "graph/document.h"
#include "graph/pipeline.h"
#include "graph/types/load_plugin.h"
#include "graph/types/registry.h"

namespace fluidcarve {

/// Checks a document against the registry. Opens no data files.
/// @param plugins  the plugin files whose node types the registry has (load_plugins)
/// @return the pipeline; not usable if problems were added
Pipeline build_pipeline(const Document& document, const Registry& registry, Problems& problems,
                        PluginFiles plugins = {});

}  // namespace fluidcarve
