#pragma once

#include "graph/pipeline.h"

#include <string>
#include <vector>

namespace fluidcarve {

/// The pipeline in Graphviz's DOT language: nodes are coloured by rate, tooltips show ports and
/// types.
std::string to_dot(const Pipeline& pipeline, const Registry& registry);

/// The pipeline as a self-contained SVG: data flows from left to right, nodes are coloured by rate,
/// nodes that gather all frames have a heavy border, tooltips show ports and types. The background
/// is transparent, for light and dark pages.
std::string to_svg(const Pipeline& pipeline, const Registry& registry);

/// Style of a node in the SVG of a report page.
struct NodeLook {
    std::string style;  ///< CSS class
    std::string note;   ///< a line of text below name and type
};
/// The SVG for a page that has its own colours and legend. The CSS variable `--width` holds its
/// width in pixels.
/// @param looks  one per node
std::string to_svg(const Pipeline& pipeline, const Registry& registry,
                   const std::vector<NodeLook>& looks);

}  // namespace fluidcarve
