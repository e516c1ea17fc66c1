#include "graph/pipeline.h"
#include "tools/draft/draft.h"

#include <algorithm>

namespace fluidcarve {

DraftRequest::Fields draft_preview(const Pipeline& pipeline) {
    const auto carved = std::ranges::find_if(
        pipeline.nodes, [](const Node& node) { return node.type->name == "remap.grids"; });
    if (carved == pipeline.nodes.end() || carved->inputs.front().empty()) return {};
    const auto& link = carved->inputs.front().front();
    const auto& source = pipeline.nodes[link.node];
    const bool picture = source.type->name == "image.read";
    // A reader's further outputs are called as its grids; other nodes give one grid.
    const auto first = std::ranges::find_if(source.outputs, [&](const OutputSpec& output) {
        return &output != &source.outputs.front();
    });
    const auto grid = picture                         ? "G"
                      : first != source.outputs.end() ? first->name
                                                      : source.outputs.at(link.output).name;
    return {{"type", "preview.sheet"},
            {"before", source.name},
            {"after", carved->name},
            {"grid", grid},
            {"axis", picture ? "z" : "y"}};
}

}  // namespace fluidcarve
