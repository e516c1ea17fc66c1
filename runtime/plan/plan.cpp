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
    // A list, since pipelines may be deeper than the program's stack.
    std::vector<std::size_t> open{node};
    while (!open.empty()) {
        const auto& inputs = pipeline.nodes[open.back()].inputs;
        open.pop_back();
        for (const auto& links : inputs)
            for (const auto& link : links)
                if (pipeline.nodes[link.node].rate == Rate::frame && !flags[link.node]) {
                    flags[link.node] = true;
                    if (!pipeline.nodes[link.node].retimes()) open.push_back(link.node);
                }
    }
}

/// Per node: whether it is `from` or depends on it.
std::vector<bool> downstream_of(const Pipeline& pipeline, std::size_t from) {
    std::vector<bool> out(pipeline.nodes.size(), false);
    out[from] = true;
    for (std::size_t n = from + 1; n < out.size(); ++n)
        for (const auto& link : pipeline.nodes[n].links()) out[n] = out[n] || out[link.node];
    return out;
}

std::size_t index_of(const Pipeline& pipeline, std::string_view name) {
    return static_cast<std::size_t>(pipeline.find(name) - pipeline.nodes.data());
}

/// The parsed `to` of a RunTarget.
struct Target {
    std::size_t node;
    bool digests;  ///< NODE.INPUT: only the digests of the gathering node NODE
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
    if (std::ranges::any_of(node->outputs, has)) return Target{out.node, false};
    fault = fmt::format(
        "{}: '{}' ({}) has no output '{}'{}", option, node->name, node->type->name, port,
        takes ? ", nor an input of this name" : ", and no input that it takes frame by frame");
    return std::nullopt;
}

/// The nodes that a RunTarget names.
/// @param fault  set to what is wrong with the first that can't be one
std::vector<Target> targets_of(const RunTarget& wanted, const Pipeline& pipeline,
                               std::string& fault) {
    std::vector<Target> out;
    std::istringstream names(wanted.to);
    for (std::string name; fault.empty() && std::getline(names, name, ',');)
        if (const auto target = target_of(name, wanted.only ? "--only" : "--to", pipeline, fault))
            out.push_back(*target);
    return out;
}

/// Makes a Plan.
class Planner {
public:
    Planner(const Pipeline& pipeline, const RunTarget& wanted)
        : pipeline_(pipeline), count_(pipeline.nodes.size()), ready_(count_, 0) {
        out_.targets.assign(count_, false);
        out_.in_sequence.assign(count_, false);
        out_.gathered_in.assign(count_, 0);
        out_.digested.assign(count_, false);
        find_targets(wanted);
    }

    Plan make() {
        make_passes();
        for (std::size_t n = 0; n < count_; ++n)
            if (out_.needed[n]) place(n);
        for (auto& pass : out_.passes) find_per_frame(pass);
        return std::move(out_);
    }

private:
    void find_targets(const RunTarget& wanted) {
        auto targets = pipeline_.leaves();
        if (!wanted.to.empty()) {
            std::string fault;
            targets.clear();
            for (const auto& target : targets_of(wanted, pipeline_, fault)) {
                targets.push_back(target.node);
                out_.digested[target.node] = target.digests;
            }
        }
        if (!wanted.from.empty())
            std::erase_if(targets,
                          [after = downstream_of(pipeline_, index_of(pipeline_, wanted.from))](
                              std::size_t n) { return !after[n]; });
        out_.needed = pipeline_.upstream_of(targets);
        for (const auto n : targets) out_.targets[n] = !out_.digested[n];
    }

    /// Finds in which passes nodes can run, and how many passes there are.
    void make_passes() {
        std::size_t passes = 0;
        for (std::size_t n = 0; n < count_; ++n) {
            const auto& node = pipeline_.nodes[n];
            for (const auto& link : node.links())
                ready_[n] = std::max(ready_[n], ready_[link.node]);
            out_.gathered_in[n] = ready_[n];
            if (node.streams_in()) ++ready_[n];
            if (out_.needed[n])
                passes = std::max(passes, node.streams_in() ? out_.gathered_in[n] + 1 : ready_[n]);
            if (out_.targets[n] && node.rate == Rate::frame)
                passes = std::max(passes, ready_[n] + 1);
        }
        out_.passes.resize(passes);
    }

    /// Enters a node in the passes in which it gathers, delivers, or runs once.
    void place(std::size_t n) {
        const auto& node = pipeline_.nodes[n];
        if (node.streams_in()) {
            auto& pass = out_.passes[out_.gathered_in[n]];
            pass.gathering.push_back(n);
            pass.gathering_needs.emplace_back(count_, false);
            mark_upstream(pipeline_, n, pass.gathering_needs.back());
        }
        if (node.rate == Rate::frame) {
            if (out_.targets[n]) out_.passes[ready_[n]].delivers.push_back(n);
        } else if (!node.streams_in()) {
            const bool in_pass = ready_[n] < out_.passes.size();
            (in_pass ? out_.passes[ready_[n]].before : out_.after).push_back(n);
        }
    }

    /// Finds the nodes of a pass that run per frame, and those that a gathering node needs.
    void find_per_frame(Pass& pass) {
        std::vector<bool> runs(count_, false);
        for (const auto n : pass.delivers) {
            runs[n] = true;
            if (!pipeline_.nodes[n].retimes()) mark_upstream(pipeline_, n, runs);
        }
        for (const auto& needs : pass.gathering_needs)
            for (std::size_t n = 0; n < count_; ++n)
                if (needs[n]) runs[n] = out_.in_sequence[n] = true;
        for (std::size_t n = 0; n < count_; ++n)
            if (runs[n]) pass.per_frame.push_back(n);
    }

    const Pipeline& pipeline_;
    const std::size_t count_;
    /// Per node: the first pass in which it can run per frame. What it makes once is there before
    /// that pass.
    std::vector<std::size_t> ready_;
    Plan out_;
};

}  // namespace

bool digests_apart(const Node& node) {
    return node.streams_in() && node.type->digest != typeid(void) && node.digests_kept;
}

bool gathers_apart(const Node& node) {
    return node.streams_in() && node.rate != Rate::frame && node.kept && !node.outputs.empty() &&
           (node.type->growth || node.type->digest == typeid(void));
}

std::string fault_of(const RunTarget& wanted, const Pipeline& pipeline) {
    std::string fault;
    const auto targets = targets_of(wanted, pipeline, fault);
    if (!fault.empty() || wanted.from.empty()) return fault;
    if (!pipeline.find(wanted.from))
        return fmt::format("--from: there is no node '{}'{}", wanted.from,
                           did_you_mean(wanted.from, pipeline.node_names()));
    const auto after = downstream_of(pipeline, index_of(pipeline, wanted.from));
    for (const auto& target : targets)
        if (!after[target.node])
            return fmt::format("--from {} --to {}: '{}' does not depend on '{}'", wanted.from,
                               wanted.to, pipeline.nodes[target.node].name, wanted.from);
    return {};
}

Plan make_plan(const Pipeline& pipeline, const RunTarget& wanted) {
    return Planner(pipeline, wanted).make();
}

}  // namespace fluidcarve
