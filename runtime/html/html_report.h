#pragma once

#include "graph/pipeline.h"
#include "graph/views/value_sources.h"
#include "runtime/html/written_files.h"

#include <nlohmann/json.hpp>

#include <string>

namespace fluidcarve {

/// What the report page shows.
struct RunShown {
    const Pipeline& pipeline;
    const Registry& registry;
    const ValueSources& sources;           ///< of the pipeline's values
    const nlohmann::ordered_json& report;  ///< as returned by Report::to_json
    const WrittenFiles& files;
    std::string when;  ///< time of the run
};
/// The report of a run as one self-contained HTML page, without scripts or external files. For wide
/// and narrow, light and dark screens.
std::string to_html(const RunShown& run);

}  // namespace fluidcarve
