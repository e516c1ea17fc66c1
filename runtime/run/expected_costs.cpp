#include "runtime/run/expected_costs.h"

#include <utility>

namespace fluidcarve {
namespace {

/// Items that a growing result lacks.
/// @param measured  from an earlier run; gives ItemCount::all_items if nothing is kept
std::size_t items_to_find(const Node& node, const std::optional<GrownResult>& kept,
                          const std::optional<WorkTime>& measured) {
    if (!node.type->growth) return 0;
    const auto wanted =
        node.type->growth->wanted(node.params.get(), kept       ? kept->items.all_items
                                                     : measured ? measured->at.all_items
                                                                : 0);
    const auto found = kept ? kept->items.count : 0;
    return wanted > found ? wanted - found : 0;
}

}  // namespace

std::vector<NodeCost> expected_costs(const Pipeline& pipeline, std::uint64_t input_bytes,
                                     const std::vector<std::optional<GrownResult>>& grown,
                                     const std::vector<NodeWork>& work, const History& history,
                                     const RunOptions& options) {
    std::vector<NodeCost> out(pipeline.nodes.size());
    for (std::size_t n = 0; n < out.size(); ++n) {
        const auto& node = pipeline.nodes[n];
        out[n] = history.cost(node.name, node.type->name);
        const auto adapt = [&](Work kind, std::size_t times) {
            auto& cost = out[n][kind];
            if (!cost) return;
            CostSetting now;
            now.abreast = options.abreast(kind == Work::once ? std::nullopt : std::optional(times));
            now.input_bytes = input_bytes;
            if (kind == Work::once) {
                if (work[n].once) now.gathered = work[n].gathered();
                now.items = items_to_find(node, grown[n], cost);
            }
            cost = WorkTime{seconds_in(*cost, now), now};
        };
        adapt(Work::frame, work[n].runs);
        adapt(Work::consume, work[n].consumed_inputs);
        adapt(Work::load, work[n].loads());
        adapt(Work::once, 1);
        if (const auto then = out[n].bytes_of_input; then > 0 && input_bytes > 0)
            out[n].bytes = static_cast<std::uint64_t>(static_cast<double>(out[n].bytes) *
                                                      static_cast<double>(input_bytes) /
                                                      static_cast<double>(then));
    }
    return out;
}

double expected_seconds(const NodeCost& cost, const NodeWork& work, bool& known) {
    double out = 0;
    for (const auto& [kind, times] :
         {std::pair(Work::frame, work.runs), std::pair(Work::consume, work.consumed_inputs),
          std::pair(Work::load, work.loads()),
          std::pair(Work::once, std::size_t{work.once ? 1U : 0U})}) {
        if (times == 0) continue;
        if (cost[kind]) out += static_cast<double>(times) * cost[kind]->seconds;
        // Loading takes little time, even if it was never measured.
        else if (kind != Work::load) known = false;
    }
    return out;
}

}  // namespace fluidcarve
