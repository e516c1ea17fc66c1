#include "runtime/run/carried_facts.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace fluidcarve {

CarriedFacts::CarriedFacts(const Pipeline& pipeline)
    : pipeline_(pipeline), known_(pipeline.nodes.size()) {}

CarriedFacts::Key CarriedFacts::key(const Link& link, int frame) const {
    return {pipeline_.nodes[link.node].rate == Rate::fixed ? 0 : frame, link.output};
}

const CarriedFacts::KnownFact* CarriedFacts::known(const Link& link, int frame) const {
    const auto found = known_[link.node].find(key(link, frame));
    return found == known_[link.node].end() ? nullptr : &found->second;
}

void CarriedFacts::deliver(std::size_t node, int frame, std::string_view output,
                           SurveyedFacts what) {
    const auto& outputs = pipeline_.nodes[node].outputs;
    const auto found = std::ranges::find(outputs, output, &OutputSpec::name);
    if (found == outputs.end()) return;
    known_[node][key({node, static_cast<std::size_t>(found - outputs.begin())}, frame)] = {
        std::move(what), node};
}

const SurveyedFacts* CarriedFacts::receives(std::size_t node, int frame,
                                            std::string_view input) const {
    const auto& inputs = pipeline_.nodes[node].type->inputs;
    const auto found = std::ranges::find(inputs, input, &InputSpec::name);
    if (found == inputs.end()) return nullptr;
    const auto& links =
        pipeline_.nodes[node].inputs[static_cast<std::size_t>(found - inputs.begin())];
    const auto* const out =
        links.size() == 1 && links.front().part.empty() ? known(links.front(), frame) : nullptr;
    return out ? &out->what : nullptr;
}

std::string CarriedFacts::carry(std::size_t n, int frame) {
    const auto& node = pipeline_.nodes[n];
    if (const auto* const from = receives(n, frame, node.type->names_from))
        known_[n][key({n, 0}, frame)] = {{from->grids, std::nullopt}, n};
    if (!node.type->in_place) return {};

    const KnownFact* first = nullptr;
    for (const auto& link : node.links()) {
        const auto* const each = known(link, frame);
        if (!each || !each->what.pixels) continue;
        if (!first) first = each;
        const auto [width, height] = *first->what.pixels;
        const auto [other_width, other_height] = *each->what.pixels;
        if (width != other_width || height != other_height)
            return fmt::format(
                "it lays pictures of two sizes over each other: '{}' reads {} x {} pixels, but "
                "'{}' {} x {}; scale one of them to the size of the other",
                pipeline_.nodes[first->reader].name, width, height,
                pipeline_.nodes[each->reader].name, other_width, other_height);
    }
    if (!first) return {};
    for (std::size_t output = 0; output < node.outputs.size(); ++output)
        known_[n][key({n, output}, frame)] = {{std::nullopt, first->what.pixels}, first->reader};
    return {};
}

}  // namespace fluidcarve
