#include "runtime/plan.h"

#include <fmt/format.h>

#include <algorithm>

namespace fluidcarve {
namespace {

bool streams_in(const Node& node) { return node.gathers && node.per_frame_input; }

/// The per-frame nodes that `node` needs in one pass, marked in `flags`.
void mark_upstream(const Pipeline& pipeline, std::size_t node, std::vector<bool>& flags) {
    for (const auto& links : pipeline.nodes[node].inputs)
        for (const auto& link : links)
            if (pipeline.nodes[link.node].rate == Rate::frame && !flags[link.node]) {
                flags[link.node] = true;
                mark_upstream(pipeline, link.node, flags);
            }
}

std::string names(const Pipeline& pipeline, const std::vector<std::size_t>& nodes) {
    std::string out;
    for (const auto n : nodes) out += (out.empty() ? "" : ", ") + pipeline.nodes[n].name;
    return out;
}

}  // namespace

Plan make_plan(const Pipeline& pipeline, const std::string& to) {
    const auto count = pipeline.nodes.size();
    std::vector<std::size_t> targets = pipeline.leaves();
    if (!to.empty()) targets = {static_cast<std::size_t>(pipeline.find(to) - pipeline.nodes.data())};
    const auto needed = pipeline.upstream_of(targets);

    // `ready[n]`: the pass from which on n can run per frame, or before which its once-made outputs are there.
    std::vector<std::size_t> ready(count, 0);
    std::vector<std::size_t> gathered(count, 0);
    std::size_t passes = 0;
    for (std::size_t n = 0; n < count; ++n) {
        const auto& node = pipeline.nodes[n];
        for (const auto& links : node.inputs)
            for (const auto& link : links) ready[n] = std::max(ready[n], ready[link.node]);
        gathered[n] = ready[n];
        if (streams_in(node)) ++ready[n];
        if (needed[n]) passes = std::max(passes, streams_in(node) ? gathered[n] + 1 : ready[n]);
    }

    Plan out;
    out.targets.assign(count, false);
    for (const auto n : targets) out.targets[n] = true;
    for (const auto n : targets)
        if (pipeline.nodes[n].rate == Rate::frame) passes = std::max(passes, ready[n] + 1);
    out.passes.resize(passes);
    for (auto& pass : out.passes) pass.delivery_needs.assign(count, false);
    for (std::size_t n = 0; n < count; ++n) {
        if (!needed[n]) continue;
        const auto& node = pipeline.nodes[n];
        if (streams_in(node)) {
            auto& pass = out.passes[gathered[n]];
            pass.gatherers.push_back(n);
            pass.gatherer_needs.emplace_back(count, false);
            mark_upstream(pipeline, n, pass.gatherer_needs.back());
        }
        if (node.rate == Rate::frame) {
            if (!out.targets[n]) continue;
            auto& pass = out.passes[ready[n]];
            pass.delivers.push_back(n);
            pass.delivery_needs[n] = true;
            mark_upstream(pipeline, n, pass.delivery_needs);
        } else if (!streams_in(node)) {
            (ready[n] < passes ? out.passes[ready[n]].before : out.after).push_back(n);
        }
    }
    for (auto& pass : out.passes)
        for (std::size_t n = 0; n < count; ++n)
            if (pass.delivery_needs[n] || std::any_of(pass.gatherer_needs.begin(), pass.gatherer_needs.end(), [n](const auto& needs) { return needs[n]; }))
                pass.per_frame.push_back(n);
    return out;
}

std::string to_text(const Plan& plan, const Pipeline& pipeline, std::size_t delivered) {
    const auto all = pipeline.frames.frames().size();
    std::string out = fmt::format("{}: {} nodes, frames {} ({})\n", pipeline.name, pipeline.nodes.size(), pipeline.frames.text(), all);
    for (std::size_t p = 0; p < plan.passes.size(); ++p) {
        const auto& pass = plan.passes[p];
        if (!pass.before.empty()) out += fmt::format("once: {}\n", names(pipeline, pass.before));
        out += fmt::format("pass {} of {}: {} frames\n", p + 1, plan.passes.size(), pass.gatherers.empty() ? delivered : all);
        out += fmt::format("  per frame: {}\n", names(pipeline, pass.per_frame));
        if (!pass.gatherers.empty()) out += fmt::format("  gathers:   {}\n", names(pipeline, pass.gatherers));
        if (!pass.delivers.empty()) out += fmt::format("  delivers:  {} ({} frames)\n", names(pipeline, pass.delivers), delivered);
    }
    if (!plan.after.empty()) out += fmt::format("once: {}\n", names(pipeline, plan.after));
    return out;
}

}  // namespace fluidcarve
