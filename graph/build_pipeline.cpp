#include "graph/build_pipeline.h"

#include "graph/pipeline_builder.h"

#include <utility>

namespace fluidcarve {

Pipeline build_pipeline(const Document& document, const Registry& registry, Problems& problems,
                        PluginFiles plugins) {
    auto out = PipelineBuilder(document, registry, problems).build();
    out.plugins = std::move(plugins);
    return out;
}

}  // namespace fluidcarve
