#pragma once

#include "graph/pipeline.h"

#include <string>
#include <vector>

namespace fluidcarve {

/// The pipeline for Graphviz: boxes coloured by rate, ports and types as tooltips.
std::string to_dot(const Pipeline& pipeline, const Registry& registry);

/// The pipeline as a picture that stands alone: data flows from left to right, boxes are coloured by rate, nodes that
/// gather all frames have a heavy border, ports and types are tooltips. No background: it fits light and dark pages.
std::string to_svg(const Pipeline& pipeline, const Registry& registry);

/// How a node looks in the picture of a page, and what that says of it.
struct NodeLook {
    std::string style;  ///< a class of the page's style sheet
    std::string note;   ///< a line below name and type
};
/// The picture for a page that has colours and a legend of its own; its style sheet finds the width as `--width`. @param looks  per node
std::string to_svg(const Pipeline& pipeline, const Registry& registry, const std::vector<NodeLook>& looks);

}  // namespace fluidcarve
