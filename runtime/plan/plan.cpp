#include "runtime/plan/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>

namespace fluidcarve {
namespace {

/// Marks in `flags` the per-frame nodes that `node` needs in its pass.
void mark_upstream(const Pipeline& pipeline, std::size_t node, std::vector<bool>& flags) {
    for (const auto& links : pipeline.nodes[node].inputs)
        for (const auto& link : links)
            if (pipeline.nodes[link.node].rate == Rate::frame && !flags[link.node]) {
                flags[link.node] = true;
                mark_upstream(pipeline, link.node, flags);
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

std::size_t index_of(const Pipeline& pipeline, std::string_view name) { return static_cast<std::size_t>(pipeline.find(name) - pipeline.nodes.data()); }

/// The parsed `to` of a wish.
struct Target {
    std::size_t node;
    bool digests;  ///< NODE.INPUT: only the digests of the gatherer NODE
};

std::optional<Target> target_of(const std::string& to, const Pipeline& pipeline, std::string& fault) {
    const auto dot = to.find('.');
    const auto* const node = pipeline.find(to.substr(0, dot));
    if (!node)
        return fault = fmt::format("--to: there is no node '{}'{}", to.substr(0, dot), did_you_mean(to.substr(0, dot), pipeline.node_names())), std::nullopt;
    const Target out{static_cast<std::size_t>(node - pipeline.nodes.data()), dot != std::string::npos};
    if (!out.digests) return out;
    const auto port = to.substr(dot + 1);
    const bool takes = node->type->digest != typeid(void) && node->streams_in();
    if (takes && node->type->input(port)) return out;
    const auto has = [&](const OutputSpec& output) { return output.name == port; };
    if (std::any_of(node->outputs.begin(), node->outputs.end(), has)) return Target{out.node, false};
    fault = fmt::format("--to: '{}' ({}) has no output '{}'{}", node->name, node->type->name, port,
                        takes ? ", nor an input of this name" : ", and no input that it takes frame by frame");
    return std::nullopt;
}

/// Makes a Schedule: starts at the targets and follows inputs that are not cached.
class Scheduler {
public:
    using Action = Schedule::Action;
    Scheduler(const Pipeline& pipeline, const Plan& plan, const std::vector<bool>& delivered, const Known& known)
        : pipeline_(pipeline), plan_(plan), delivered_(delivered), known_(known) {
        const auto nodes = pipeline.nodes.size();
        out_.frames.assign(plan.passes.size(), std::vector(delivered.size(), std::vector<Action>(nodes, Action::none)));
        out_.once.assign(nodes, Action::none);
        out_.gathers.assign(nodes, 0);
    }

    Schedule make() {
        for (std::size_t n = 0; n < pipeline_.nodes.size(); ++n)
            if (plan_.targets[n] && pipeline_.nodes[n].rate != Rate::frame && !known_.result(n, 0)) once(n);
        for (std::size_t pass = 0; pass < plan_.passes.size(); ++pass) deliver(pass);
        // The first round found everything that must run. In the second round later passes load what earlier passes cache.
        earlier_kept_ = true;
        for (std::size_t pass = 0; pass < plan_.passes.size(); ++pass) {
            for (auto& actions : out_.frames[pass]) std::fill(actions.begin(), actions.end(), Action::none);
            for (const auto n : plan_.passes[pass].gatherers)
                if (out_.gathers[n]) take(n);
            deliver(pass);
        }
        return std::move(out_);
    }

private:
    /// Schedules the targets of a pass that run per frame.
    void deliver(std::size_t pass) {
        for (std::size_t place = 0; place < delivered_.size(); ++place) {
            if (!delivered_[place]) continue;
            for (const auto n : plan_.passes[pass].delivers)
                if (!known_.result(n, place)) frame(n, place, pass);
            if (plan_.digested && plan_.gathered_in[*plan_.digested] == pass) take(*plan_.digested, place);
        }
    }

    void once(std::size_t n) {
        auto& action = out_.once[n];
        if (action != Action::none) return;
        action = known_.result(n, 0) ? Action::load : Action::run;
        if (action == Action::load) return;
        if (pipeline_.nodes[n].streams_in()) gather(n);
        else inputs(n, 0, 0);
    }

    void frame(std::size_t n, std::size_t place, std::size_t pass) {
        auto& action = out_.frames[pass][place][n];
        if (action != Action::none) return;
        action = known_.result(n, place) || kept_earlier(n, place, pass) ? Action::load : Action::run;
        if (action == Action::load) return;
        if (pipeline_.nodes[n].streams_in()) gather(n);
        inputs(n, place, pass);
    }

    bool kept_earlier(std::size_t n, std::size_t place, std::size_t pass) const {
        if (!earlier_kept_ || !pipeline_.nodes[n].kept || !known_.keeps(n, place)) return false;
        // In the pass in which a node gathers, its action says how it takes the frame.
        const std::size_t first = pipeline_.nodes[n].streams_in() ? plan_.gathered_in[n] + 1 : 0;
        for (auto earlier = first; earlier < pass; ++earlier)
            if (out_.frames[earlier][place][n] != Action::none) return true;
        return false;
    }

    void gather(std::size_t n) {
        if (out_.gathers[n]) return;
        out_.gathers[n] = 1;
        take(n);
        for (const auto& links : pipeline_.nodes[n].inputs)
            for (const auto& link : links)
                if (pipeline_.nodes[link.node].rate != Rate::frame) once(link.node);
    }

    void take(std::size_t n) {
        for (std::size_t place = 0; place < delivered_.size(); ++place)
            if (known_.wants(n, place)) take(n, place);
    }

    void take(std::size_t n, std::size_t place) {
        const auto pass = plan_.gathered_in[n];
        auto& action = out_.frames[pass][place][n];
        if (action != Action::none) return;
        action = known_.taken(n, place) ? Action::load : Action::run;
        if (action == Action::run) inputs(n, place, pass);
    }

    void inputs(std::size_t n, std::size_t place, std::size_t pass) {
        for (const auto& links : pipeline_.nodes[n].inputs)
            for (const auto& link : links) {
                if (pipeline_.nodes[link.node].rate == Rate::frame) frame(link.node, place, pass);
                else once(link.node);
            }
    }

    const Pipeline& pipeline_;
    const Plan& plan_;
    const std::vector<bool>& delivered_;
    const Known& known_;
    Schedule out_;
    bool earlier_kept_ = false;
};

}  // namespace

std::string fault_of(const Wish& wish, const Pipeline& pipeline) {
    std::string fault;
    std::optional<Target> to;
    if (!wish.to.empty() && !(to = target_of(wish.to, pipeline, fault))) return fault;
    if (wish.from.empty()) return {};
    if (!pipeline.find(wish.from)) return fmt::format("--from: there is no node '{}'{}", wish.from, did_you_mean(wish.from, pipeline.node_names()));
    if (to && !downstream_of(pipeline, index_of(pipeline, wish.from))[to->node])
        return fmt::format("--from {} --to {}: '{}' does not depend on '{}'", wish.from, wish.to, pipeline.nodes[to->node].name, wish.from);
    return {};
}

Plan make_plan(const Pipeline& pipeline, const Wish& wish) {
    const auto count = pipeline.nodes.size();
    std::vector<std::size_t> targets = pipeline.leaves();
    Plan out;
    out.targets.assign(count, false);
    out.gathered_in.assign(count, 0);
    if (!wish.to.empty()) {
        std::string fault;
        const auto to = *target_of(wish.to, pipeline, fault);
        targets = {to.node};
        if (to.digests) out.digested = to.node;
    }
    if (!wish.from.empty()) std::erase_if(targets, [after = downstream_of(pipeline, index_of(pipeline, wish.from))](std::size_t n) { return !after[n]; });
    out.needed = pipeline.upstream_of(targets);

    // `ready[n]`: the first pass in which n can run per frame; outputs that n makes once are available before that pass.
    std::vector<std::size_t> ready(count, 0);
    std::size_t passes = 0;
    for (std::size_t n = 0; n < count; ++n) {
        const auto& node = pipeline.nodes[n];
        for (const auto& links : node.inputs)
            for (const auto& link : links) ready[n] = std::max(ready[n], ready[link.node]);
        out.gathered_in[n] = ready[n];
        if (node.streams_in()) ++ready[n];
        if (out.needed[n]) passes = std::max(passes, node.streams_in() ? out.gathered_in[n] + 1 : ready[n]);
    }
    if (!out.digested)
        for (const auto n : targets) out.targets[n] = true;
    for (const auto n : targets)
        if (out.targets[n] && pipeline.nodes[n].rate == Rate::frame) passes = std::max(passes, ready[n] + 1);
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
            mark_upstream(pipeline, n, flags);
        }
        for (const auto& needs : pass.gatherer_needs)
            for (std::size_t n = 0; n < count; ++n) flags[n] = flags[n] || needs[n];
        for (std::size_t n = 0; n < count; ++n)
            if (flags[n]) pass.per_frame.push_back(n);
    }
    return out;
}

Schedule make_schedule(const Pipeline& pipeline, const Plan& plan, const std::vector<bool>& delivered, const Known& known) {
    return Scheduler(pipeline, plan, delivered, known).make();
}

namespace {

/// Per place: whether a node runs, takes the frame from its inputs, or takes it from a cached digest.
struct Runs {
    std::vector<bool> run, taken, taken_kept;
};

Runs runs_of(const Pipeline& pipeline, const Plan& plan, const Schedule& schedule, std::size_t n) {
    Runs out;
    const auto places = schedule.frames.empty() ? 0 : schedule.frames.front().size();
    for (auto* flags : {&out.run, &out.taken, &out.taken_kept}) flags->assign(places, false);
    for (std::size_t pass = 0; pass < schedule.frames.size(); ++pass)
        for (std::size_t place = 0; place < places; ++place) {
            const auto action = schedule.frames[pass][place][n];
            const bool takes = pipeline.nodes[n].streams_in() && pass == plan.gathered_in[n];
            if (takes && action != Schedule::Action::none) (action == Schedule::Action::run ? out.taken : out.taken_kept)[place] = true;
            if (!takes && action == Schedule::Action::run) out.run[place] = true;
        }
    return out;
}

std::size_t number_of(const std::vector<bool>& flags) { return static_cast<std::size_t>(std::count(flags.begin(), flags.end(), true)); }

}  // namespace

std::vector<Share> shares(const Pipeline& pipeline, const Plan& plan, const Schedule& schedule, const Schedule& nothing_kept) {
    std::vector<Share> out(pipeline.nodes.size());
    for (std::size_t n = 0; n < out.size(); ++n) {
        const auto& node = pipeline.nodes[n];
        const auto now = runs_of(pipeline, plan, schedule, n), anew = runs_of(pipeline, plan, nothing_kept, n);
        auto& share = out[n];
        share.taken_anew = number_of(now.taken);
        share.taken_kept = number_of(now.taken_kept);
        if (plan.digested == n) {
            share.frames = number_of(anew.taken);
            share.runs = share.taken_anew;
            share.only_takes = true;
        } else if (node.rate == Rate::frame) {
            share.frames = number_of(anew.run);
            share.runs = number_of(now.run);
        } else if (nothing_kept.once[n] == Schedule::Action::run) {
            share.frames = node.streams_in() ? number_of(anew.taken) : 1;
            share.runs = schedule.once[n] == Schedule::Action::run ? share.frames : 0;
        }
    }
    return out;
}

}  // namespace fluidcarve
