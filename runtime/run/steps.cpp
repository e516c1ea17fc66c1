#include "runtime/run/steps.h"

#include "carve/base/frame_set.h"
#include "runtime/run/expected_costs.h"
#include "runtime/run/forecast.h"
#include "runtime/run/inputs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

namespace fluidcarve {
namespace {

using Action = Schedule::Action;
using Consume = Schedule::Consume;

/// Index of the step that makes a result; nothing: no step so far.
using Maker = std::optional<std::size_t>;

/// Per-frame nodes that a node reads in a frame, itself included, up to those whose results are
/// kept.
std::set<std::size_t> computed_with(const Pipeline& pipeline, std::size_t node) {
    std::set<std::size_t> out{node};
    std::vector<std::size_t> open{node};
    while (!open.empty()) {
        const auto n = open.back();
        open.pop_back();
        for (const auto& link : pipeline.nodes[n].links()) {
            const auto& source = pipeline.nodes[link.node];
            if (source.rate == Rate::frame && !source.kept && out.insert(link.node).second)
                open.push_back(link.node);
        }
    }
    return out;
}

/// Delivering nodes in groups, so that results that are not cached are computed for one group
/// only.
std::vector<std::vector<std::size_t>> delivering_groups(const Pipeline& pipeline,
                                                        const Plan& plan) {
    struct Group {
        std::vector<std::size_t> nodes;
        std::set<std::size_t> computed;
    };
    std::vector<Group> groups;
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n) {
        if (!plan.targets[n] || pipeline.nodes[n].rate != Rate::frame) continue;
        Group joined{{n}, computed_with(pipeline, n)};
        std::erase_if(groups, [&](const Group& group) {
            const bool shares = std::ranges::any_of(
                group.computed, [&](std::size_t node) { return joined.computed.contains(node); });
            if (!shares) return false;
            joined.nodes.insert(joined.nodes.end(), group.nodes.begin(), group.nodes.end());
            joined.computed.insert(group.computed.begin(), group.computed.end());
            return true;
        });
        std::ranges::sort(joined.nodes);
        groups.push_back(std::move(joined));
    }
    std::vector<std::vector<std::size_t>> out;
    for (auto& group : groups) out.push_back(std::move(group.nodes));
    return out;
}

/// Simulates the steps of a run one after the other, with an initially empty work folder.
class Rehearsal {
public:
    Rehearsal(const Pipeline& pipeline, const Preparation& prepared, const History& history,
              const RunOptions& options)
        : pipeline_(pipeline), prepared_(prepared), history_(history), options_(options) {
        const std::vector<Maker> nobody(std::max<std::size_t>(1, prepared.frames().size()));
        results_.assign(pipeline.nodes.size(), nobody);
        digests_ = results_;
    }

    std::vector<RunStep> steps() {
        const auto& plan = prepared_.plan();
        const auto& whole = prepared_.uncached_schedule();
        for (std::size_t n = 0; n < pipeline_.nodes.size(); ++n) {
            const auto& node = pipeline_.nodes[n];
            const auto consumed = working_frames(whole, n).consumed_inputs;
            if (digests_apart(node) && !consumed.empty()) {
                const auto& input = digested_input(node);
                add({.name = node.name + "-" + input,
                     .what = fmt::format("takes from each frame what {} needs", node.name),
                     .target = {.to = node.name + "." + input}},
                    consumed);
            }
            if (gathers_apart(node) && whole.once[n] == Action::run)
                add({.name = node.name,
                     .what =
                         fmt::format("{} from all frames",
                                     node.type->growth ? "finds " + node.type->growth->item + "s"
                                                       : "makes " + node.name),
                     .target = {.to = node.name}},
                    {});
        }
        const auto delivered = prepared_.delivered_frames();
        std::set<std::size_t> indices;
        for (std::size_t t = 0; t < prepared_.frames().size(); ++t)
            if (std::ranges::binary_search(delivered, prepared_.frames()[t])) indices.insert(t);
        for (const auto& group : delivering_groups(pipeline_, plan)) {
            std::vector<std::string> names;
            for (const auto n : group) names.push_back(pipeline_.nodes[n].name);
            constexpr std::size_t most = 3;
            const auto name = names.size() <= most
                                  ? fmt::format("{}", fmt::join(names, "-"))
                                  : fmt::format("{}-and-{}-more", names.front(), names.size() - 1);
            add({.name = name,
                 .what = fmt::format("delivers {}", fmt::join(names, ", ")),
                 .target = {.to = fmt::format("{}", fmt::join(names, ","))}},
                indices);
        }
        for (std::size_t n = 0; n < pipeline_.nodes.size(); ++n) {
            const auto& node = pipeline_.nodes[n];
            if (plan.targets[n] && node.rate != Rate::frame && !gathers_apart(node))
                add({.name = node.name,
                     .what = "delivers " + node.name,
                     .target = {.to = node.name}},
                    {});
        }
        return std::move(out_);
    }

private:
    /// The first input of a gathering node that brings it frames.
    const std::string& digested_input(const Node& node) const {
        for (std::size_t input = 0; input < node.inputs.size(); ++input)
            for (const auto& link : node.inputs[input])
                if (pipeline_.nodes[link.node].rate == Rate::frame)
                    return node.type->inputs[input].name;
        return node.type->inputs.front().name;
    }

    /// The step that has put the result of a node for frame `t` into the work folder; `t` counts
    /// only for nodes that deliver per frame.
    Maker& maker(std::size_t n, std::size_t t) {
        return results_[n][pipeline_.nodes[n].rate == Rate::frame ? t : 0];
    }

    /// Adds a step. @param indices  of the frames that it takes; empty: it is not chunked
    void add(RunStep step, const std::set<std::size_t>& indices) {
        const auto name = step.name;
        for (int n = 2; std::ranges::find(out_, step.name, &RunStep::name) != out_.end(); ++n)
            step.name = fmt::format("{}-{}", name, n);
        step.chunked = !indices.empty();
        std::vector<bool> delivered(prepared_.frames().size(), !step.chunked);
        for (const auto t : indices) {
            delivered[t] = true;
            step.frames.push_back(prepared_.frames()[t]);
        }
        const auto plan = make_plan(pipeline_, step.target);
        const auto takes = [&](std::size_t n, std::size_t t) { return prepared_.takes(n, t); };
        const auto delivers = [&](std::size_t n, std::size_t t) {
            return prepared_.delivers(n, t);
        };
        const auto schedule = make_schedule(
            pipeline_, plan, delivered,
            {[&](std::size_t n, std::size_t t) { return maker(n, t).has_value(); },
             [&](std::size_t n, std::size_t t) { return digests_[n][t].has_value(); }, takes,
             delivers, [&](std::size_t n, std::size_t) { return pipeline_.nodes[n].kept; }});
        const auto needed = makers_of(schedule);
        step.needs = without_implied(needed);
        all_needs_.push_back(closure(needed));
        step.target.only = make(schedule, plan, out_.size());
        set_resources(step, plan, work_of(schedule), indices.size());
        out_.push_back(std::move(step));
    }

    /// The steps whose results a schedule loads.
    std::set<std::size_t> makers_of(const Schedule& schedule) {
        std::set<std::size_t> out;
        const auto need = [&](const Maker& step) {
            if (step) out.insert(*step);
        };
        for (std::size_t n = 0; n < pipeline_.nodes.size(); ++n) {
            if (schedule.once[n] == Action::load) need(maker(n, 0));
            for (const auto& pass : schedule.frames)
                for (std::size_t t = 0; t < pass.size(); ++t) {
                    if (pass[t].results[n] == Action::load) need(maker(n, t));
                    if (pass[t].consumes[n] == Consume::digest) need(digests_[n][t]);
                }
        }
        return out;
    }

    /// Records the results that a step leaves in the work folder.
    /// @return whether all results that it makes there are its targets
    bool make(const Schedule& schedule, const Plan& plan, std::size_t step) {
        bool only_targets = true;
        const auto made = [&](std::size_t n, std::size_t t) {
            if (!pipeline_.nodes[n].kept) return;
            maker(n, t) = step;
            only_targets = only_targets && (plan.targets[n] || plan.digested[n]);
        };
        for (std::size_t n = 0; n < pipeline_.nodes.size(); ++n) {
            if (schedule.once[n] == Action::run) made(n, 0);
            for (const auto& pass : schedule.frames)
                for (std::size_t t = 0; t < pass.size(); ++t) {
                    if (pass[t].results[n] == Action::run) made(n, t);
                    if (pass[t].consumes[n] == Consume::inputs && digests_apart(pipeline_.nodes[n]))
                        digests_[n][t] = step;
                }
        }
        return only_targets;
    }

    /// Steps and all that they wait for.
    std::set<std::size_t> closure(const std::set<std::size_t>& steps) const {
        auto out = steps;
        for (const auto step : steps) out.insert(all_needs_[step].begin(), all_needs_[step].end());
        return out;
    }

    std::vector<std::size_t> without_implied(const std::set<std::size_t>& steps) const {
        std::vector<std::size_t> out;
        for (const auto step : steps)
            if (std::ranges::none_of(
                    steps, [&](std::size_t other) { return all_needs_[other].contains(step); }))
                out.push_back(step);
        return out;
    }

    /// @param works  per node: in all frames of the step. @param all  how many these are
    void set_resources(RunStep& step, const Plan& plan, std::vector<NodeWork> works,
                       std::size_t all) const {
        // A step may read fewer grids than the whole run, and so has frames of another size.
        const auto deliver = step.chunked ? std::optional(FrameSet(step.frames)) : std::nullopt;
        Report unused(pipeline_);
        const auto input_bytes = survey_inputs(pipeline_, plan, deliver, false, unused).frame_bytes;
        const std::vector<std::optional<GrownResult>> grown(works.size());
        const auto expected =
            expected_costs(pipeline_, input_bytes, grown, works, history_, options_);
        step.resources = [&pipeline = pipeline_, options = options_, input_bytes,
                          works = std::move(works), expected, all](std::size_t frames) {
            RunResources out{.cores = options.threads};
            double seconds = 0;
            bool known = true;
            const auto part = [&](std::size_t count) {
                return all == 0 ? count : (count * std::min(frames, all) + all - 1) / all;
            };
            for (std::size_t n = 0; n < works.size(); ++n) {
                const auto& node = pipeline.nodes[n];
                auto work = works[n];
                for (auto* const count :
                     {&work.frames, &work.runs, &work.consumed_inputs, &work.loaded_results})
                    *count = part(*count);
                seconds += expected_seconds(expected[n], work, known);
                out.memory += memory_of(node, expected[n], work, input_bytes, options);
                out.disk += disk_of(node, expected[n], work, input_bytes);
            }
            if (known) out.seconds = seconds;
            return out;
        };
    }

    const Pipeline& pipeline_;
    const Preparation& prepared_;
    const History& history_;
    const RunOptions& options_;
    std::vector<std::vector<Maker>> results_, digests_;  ///< `[node][t]`
    std::vector<std::set<std::size_t>> all_needs_;       ///< per step: all that it waits for
    std::vector<RunStep> out_;
};

}  // namespace

std::vector<RunStep> steps_of(const Pipeline& pipeline, const Preparation& prepared,
                              const History& history, const RunOptions& options) {
    return Rehearsal(pipeline, prepared, history, options).steps();
}

nlohmann::ordered_json to_json(const std::vector<RunStep>& steps) {
    auto out = nlohmann::ordered_json::array();
    for (const auto& step : steps) {
        std::vector<std::string> needs;
        for (const auto need : step.needs) needs.push_back(steps[need].name);
        const auto resources = step.resources(step.frames.size());
        auto& entry = out.emplace_back(
            nlohmann::ordered_json{{"name", step.name}, {"what", step.what}, {"needs", needs}});
        if (step.chunked) entry["frames"] = FrameSet(step.frames).text();
        entry.update(
            {{"cores", resources.cores}, {"memory", resources.memory}, {"disk", resources.disk}});
        if (resources.seconds) entry["seconds"] = *resources.seconds;
    }
    return out;
}

}  // namespace fluidcarve
