#include "tools/draft/draft_preview.h"

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
    const auto grid = picture                     ? "G"
                      : source.outputs.size() > 1 ? source.outputs[1].name
                                                  : source.outputs.at(link.output).name;
    DraftRequest::Fields out{{"type", "preview.sheet"}};
    // A sequence with other frames than its source has no "before" of the same number.
    if (carved->retimes()) out.emplace_back("before", carved->name);
    else out.insert(out.end(), {{"before", source.name}, {"after", carved->name}});
    out.insert(out.end(), {{"grid", grid}, {"axis", picture ? "z" : "y"}});
    return out;
}

}  // namespace fluidcarve
