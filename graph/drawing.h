#pragma once

#include "graph/pipeline.h"

#include <string>

namespace fluidcarve {

/// The pipeline for Graphviz: boxes coloured by rate, ports and types as tooltips.
std::string to_dot(const Pipeline& pipeline, const Registry& registry);

/// The pipeline as a picture that stands alone: data flows from left to right, boxes are coloured by rate, nodes that
/// gather all frames have a heavy border, ports and types are tooltips. No background: it fits light and dark pages.
std::string to_svg(const Pipeline& pipeline, const Registry& registry);

}  // namespace fluidcarve
