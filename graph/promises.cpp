#include "graph/promises.h"

#include "carve/base/failure.h"

#include <fmt/format.h>

namespace fluidcarve {

void pass_promises(const std::vector<Node*>& nodes, Problems& problems) {
    for (auto* const node : nodes)
        for (std::size_t n = 0; n < node->inputs.size(); ++n)
            for (const auto& link : node->inputs[n]) {
                const auto& source = *nodes[link.node];
                if (!node->params || !source.params || !source.type->promise) continue;
                const auto promise = source.type->promise(source.params.get());
                if (!promise) continue;
                const auto& input = node->type->inputs[n];
                if (input.learn) node->params = input.learn(node->params.get(), promise->of);
                else
                    add(problems, node->mark,
                        fmt::format("{} input '{}' takes '{}', but {}", node->type->name,
                                    input.name, source.name, promise->fault));
            }
}

}  // namespace fluidcarve
