#include "graph/build_pipeline.h"

#include "graph/pipeline_builder.h"

namespace fluidcarve {

Pipeline build_pipeline(const Document& document, const Registry& registry, Problems& problems) {
    return PipelineBuilder(document, registry, problems).build();
}

}  // namespace fluidcarve
