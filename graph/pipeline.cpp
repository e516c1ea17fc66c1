#include "graph/pipeline.h"

#include "carve/base/find_or_null.h"

#include <fmt/format.h>

#include <algorithm>

namespace fluidcarve {

const std::string& taken_by(const Pipeline& pipeline, const Link& link) {
    return link.part.empty() ? pipeline.nodes[link.node].outputs[link.output].name : link.part;
}

Problems warnings_of(const Pipeline& pipeline) {
    Problems out;
    if (!pipeline.holes.empty()) add(out, {}, "warning: " + pipeline.holes);
    for (const auto& note : pipeline.notes) add(out, {}, "warning: " + note);
    for (const auto& node : pipeline.nodes)
        for (const auto& warning : node.warnings)
            add(out, warning.at, fmt::format("warning: {} {}", node.type->name, warning.message));
    const auto leaves = pipeline.leaves();
    const auto ends = [&](std::size_t n) { return pipeline.nodes[n].outputs.empty(); };
    if (std::ranges::none_of(leaves, ends)) return out;
    for (const auto n : leaves)
        if (const auto& node = pipeline.nodes[n]; !ends(n))
            add(out, node.mark,
                fmt::format("warning: '{}' ({}) runs, although no node takes its outputs: connect "
                            "it, or leave it out",
                            node.name, node.type->name));
    return out;
}

std::vector<Node::Written> Node::written() const {
    std::vector<Written> out;
    for (const auto& spec : type->params)
        if (spec.writes_file())
            if (const auto& path = spec.path(params.get()); !path.text().empty())
                out.push_back({spec, path});
    return out;
}

bool Pipeline::writes(std::size_t n) const {
    const auto& node = nodes[n];
    return node.outputs.empty() && !node.written().empty();
}

std::string to_text(Rate rate) {
    switch (rate) {
        case Rate::fixed: return "static";
        case Rate::sequence: return "sequence";
        case Rate::frame: break;
    }
    return "frame";
}

const Node* Pipeline::find(std::string_view name) const {
    return find_or_null(nodes, name, &Node::name);
}

std::vector<Link> Node::links() const {
    std::vector<Link> out;
    for (const auto& input : inputs) out.insert(out.end(), input.begin(), input.end());
    return out;
}

std::vector<std::string> Pipeline::node_names() const {
    std::vector<std::string> out;
    for (const auto& node : nodes) out.push_back(node.name);
    return out;
}

std::vector<std::size_t> Pipeline::leaves() const {
    std::vector<bool> read(nodes.size(), false);
    for (const auto& node : nodes)
        for (const auto& link : node.links()) read[link.node] = true;
    std::vector<std::size_t> out;
    for (std::size_t n = 0; n < nodes.size(); ++n)
        if (!read[n]) out.push_back(n);
    return out;
}

std::vector<bool> Pipeline::upstream_of(const std::vector<std::size_t>& targets) const {
    std::vector<bool> needed(nodes.size(), false);
    for (const auto n : targets) needed[n] = true;
    for (std::size_t n = nodes.size(); n-- > 0;) {
        if (!needed[n]) continue;
        for (const auto& link : nodes[n].links()) needed[link.node] = true;
    }
    return needed;
}

}  // namespace fluidcarve
