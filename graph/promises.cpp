#include "graph/promises.h"

#include <fmt/format.h>

namespace fluidcarve {

namespace {

/// Lets an input of a node learn what the source of one of its connections promises.
void pass_promise(const Node& source, std::size_t n, Node& node, Problems& problems) {
    if (!node.params || !source.params || !source.type->promise) return;
    const auto promise = source.type->promise(source.params.get());
    if (!promise) return;
    const auto& input = node.type->inputs[n];
    if (input.learn) node.params = input.learn(node.params.get(), promise->fact);
    else
        add(problems, node.mark,
            fmt::format("{} input '{}' takes '{}', but {}", node.type->name, input.name,
                        source.name, promise->fault));
}

}  // namespace

void pass_promises(const std::vector<Node*>& nodes, Problems& problems) {
    for (auto* const node : nodes)
        for (std::size_t n = 0; n < node->inputs.size(); ++n)
            for (const auto& link : node->inputs[n])
                pass_promise(*nodes[link.node], n, *node, problems);
}

}  // namespace fluidcarve
