#include "runtime/plan/plan.h"

#include "carve/base/words.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <sstream>
#include <string_view>

namespace fluidcarve {
namespace {

/// Marks in `flags` the per-frame nodes that `node` needs in its pass. A node that retimes has
/// taken all its frames in an earlier pass.
void mark_upstream(const Pipeline& pipeline, std::size_t node, std::vector<bool>& flags) {
    for (const auto& links : pipeline.nodes[node].inputs)
        for (const auto& link : links)
            if (pipeline.nodes[link.node].rate == Rate::frame && !flags[link.node]) {
                flags[link.node] = true;
                if (!pipeline.nodes[link.node].retimes()) mark_upstream(pipeline, link.node, flags);
            }
}

/// Per node: whether it is `from` or depends on it.
std::vector<bool> downstream_of(const Pipeline& pipeline, std::size_t from) {
    std::vector<bool> out(pipeline.nodes.size(), false);
    out[from] = true;
    for (std::size_t n = from + 1; n < out.size(); ++n)
        for (const auto& links : pipeline.nodes[n].inputs)
            for (const auto& link : links) out[n] = out[n] || out[link.node];
    return out;
}

std::size_t index_of(const Pipeline& pipeline, std::string_view name) {
    return static_cast<std::size_t>(pipeline.find(name) - pipeline.nodes.data());
}

/// The parsed `to` of a wish.
struct Target {
    std::size_t node;
    bool digests;  ///< NODE.INPUT: only the digests of the gatherer NODE
};

std::optional<Target> target_of(const std::string& to, const char* option, const Pipeline& pipeline,
                                std::string& fault) {
    const auto dot = to.find('.');
    const auto* const node = pipeline.find(to.substr(0, dot));
    if (!node)
        return fault = fmt::format("{}: there is no node '{}'{}", option, to.substr(0, dot),
                                   did_you_mean(to.substr(0, dot), pipeline.node_names())),
               std::nullopt;
    const Target out{static_cast<std::size_t>(node - pipeline.nodes.data()),
                     dot != std::string::npos};
    if (!out.digests) return out;
    const auto port = to.substr(dot + 1);
    const bool takes = node->type->digest != typeid(void) && node->streams_in();
    if (takes && node->type->input(port)) return out;
    const auto has = [&](const OutputSpec& output) { return output.name == port; };
    if (std::any_of(node->outputs.begin(), node->outputs.end(), has))
        return Target{out.node, false};
    fault = fmt::format(
        "{}: '{}' ({}) has no output '{}'{}", option, node->name, node->type->name, port,
        takes ? ", nor an input of this name" : ", and no input that it takes frame by frame");
    return std::nullopt;
}

/// The targets that a wish names.
/// @param fault  set to the fault of the first name that can't be a target
std::vector<Target> targets_of(const Wish& wish, const Pipeline& pipeline, std::string& fault) {
    std::vector<Target> out;
    std::istringstream names(wish.to);
    for (std::string name; fault.empty() && std::getline(names, name, ',');)
        if (const auto target = target_of(name, wish.only ? "--only" : "--to", pipeline, fault))
            out.push_back(*target);
    return out;
}

}  // namespace

bool digests_apart(const Node& node) {
    return node.streams_in() && node.type->digest != typeid(void) && node.digests_kept;
}

bool gathers_apart(const Node& node) {
    return node.streams_in() && node.rate != Rate::frame && node.kept && !node.outputs.empty() &&
           (node.type->growth || node.type->digest == typeid(void));
}

std::string fault_of(const Wish& wish, const Pipeline& pipeline) {
    std::string fault;
    const auto targets = targets_of(wish, pipeline, fault);
    if (!fault.empty() || wish.from.empty()) return fault;
    if (!pipeline.find(wish.from))
        return fmt::format("--from: there is no node '{}'{}", wish.from,
                           did_you_mean(wish.from, pipeline.node_names()));
    const auto after = downstream_of(pipeline, index_of(pipeline, wish.from));
    for (const auto& target : targets)
        if (!after[target.node])
            return fmt::format("--from {} --to {}: '{}' does not depend on '{}'", wish.from,
                               wish.to, pipeline.nodes[target.node].name, wish.from);
    return {};
}

Plan make_plan(const Pipeline& pipeline, const Wish& wish) {
    const auto count = pipeline.nodes.size();
    std::vector<std::size_t> targets = pipeline.leaves();
    Plan out;
    out.targets.assign(count, false);
    out.in_sequence.assign(count, false);
    out.gathered_in.assign(count, 0);
    out.digested.assign(count, false);
    if (!wish.to.empty()) {
        std::string fault;
        targets.clear();
        for (const auto& target : targets_of(wish, pipeline, fault)) {
            targets.push_back(target.node);
            out.digested[target.node] = target.digests;
        }
    }
    if (!wish.from.empty())
        std::erase_if(targets, [after = downstream_of(pipeline, index_of(pipeline, wish.from))](
                                   std::size_t n) { return !after[n]; });
    out.needed = pipeline.upstream_of(targets);

    // `ready[n]`: the first pass in which n can run per frame; outputs that n makes once are
    // available before that pass.
    std::vector<std::size_t> ready(count, 0);
    std::size_t passes = 0;
    for (std::size_t n = 0; n < count; ++n) {
        const auto& node = pipeline.nodes[n];
        for (const auto& links : node.inputs)
            for (const auto& link : links) ready[n] = std::max(ready[n], ready[link.node]);
        out.gathered_in[n] = ready[n];
        if (node.streams_in()) ++ready[n];
        if (out.needed[n])
            passes = std::max(passes, node.streams_in() ? out.gathered_in[n] + 1 : ready[n]);
    }
    for (const auto n : targets) out.targets[n] = !out.digested[n];
    for (const auto n : targets)
        if (out.targets[n] && pipeline.nodes[n].rate == Rate::frame)
            passes = std::max(passes, ready[n] + 1);
    out.passes.resize(passes);
    for (std::size_t n = 0; n < count; ++n) {
        if (!out.needed[n]) continue;
        const auto& node = pipeline.nodes[n];
        if (node.streams_in()) {
            auto& pass = out.passes[out.gathered_in[n]];
            pass.gatherers.push_back(n);
            pass.gatherer_needs.emplace_back(count, false);
            mark_upstream(pipeline, n, pass.gatherer_needs.back());
        }
        if (node.rate == Rate::frame) {
            if (out.targets[n]) out.passes[ready[n]].delivers.push_back(n);
        } else if (!node.streams_in()) {
            (ready[n] < passes ? out.passes[ready[n]].before : out.after).push_back(n);
        }
    }
    for (auto& pass : out.passes) {
        auto flags = std::vector<bool>(count, false);
        for (const auto n : pass.delivers) {
            flags[n] = true;
            if (!pipeline.nodes[n].retimes()) mark_upstream(pipeline, n, flags);
        }
        for (const auto& needs : pass.gatherer_needs)
            for (std::size_t n = 0; n < count; ++n)
                if (needs[n]) flags[n] = out.in_sequence[n] = true;
        for (std::size_t n = 0; n < count; ++n)
            if (flags[n]) pass.per_frame.push_back(n);
    }
    return out;
}

}  // namespace fluidcarve
