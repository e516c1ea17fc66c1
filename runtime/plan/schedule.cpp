#include "runtime/plan/schedule.h"

#include <algorithm>
#include <utility>

namespace fluidcarve {
namespace {

using Action = Schedule::Action;
using Consume = Schedule::Consume;

/// Makes a Schedule: starts at the targets and follows inputs that are not cached.
class Scheduler {
public:
    Scheduler(const Pipeline& pipeline, const Plan& plan, const std::vector<bool>& delivered,
              const ScheduleQueries& known)
        : pipeline_(pipeline), plan_(plan), delivered_(delivered), known_(known) {
        out_.once.assign(pipeline.nodes.size(), Action::none);
        out_.gathers.assign(pipeline.nodes.size(), 0);
    }

    Schedule make() {
        clear_frames();
        for (std::size_t n = 0; n < pipeline_.nodes.size(); ++n)
            if (plan_.targets[n] && pipeline_.nodes[n].rate != Rate::frame && !known_.result(n, 0))
                work({Visit::once, n});
        for (std::size_t pass = 0; pass < plan_.passes.size(); ++pass) deliver(pass);
        // The first round found everything that must run. In the second round later passes load
        // what earlier passes cache.
        earlier_kept_ = true;
        clear_frames();
        for (std::size_t pass = 0; pass < plan_.passes.size(); ++pass) {
            for (const auto n : plan_.passes[pass].gathering)
                if (out_.gathers[n]) work({Visit::consume_all, n});
            deliver(pass);
        }
        return std::move(out_);
    }

private:
    void clear_frames() {
        const auto nodes = pipeline_.nodes.size();
        const Schedule::Frame nothing{std::vector(nodes, Action::none),
                                      std::vector(nodes, Consume::none)};
        out_.frames.assign(plan_.passes.size(), std::vector(delivered_.size(), nothing));
    }

    /// Schedules the targets of a pass that run per frame.
    void deliver(std::size_t pass) {
        for (std::size_t t = 0; t < delivered_.size(); ++t) {
            if (!delivered_[t]) continue;
            for (const auto n : plan_.passes[pass].delivers)
                if (known_.delivers(n, t) && !known_.result(n, t)) work({Visit::frame, n, t, pass});
            for (const auto n : plan_.passes[pass].gathering)
                if (plan_.digested[n] && known_.takes(n, t)) work({Visit::consume, n, t});
        }
    }

    /// A node to be scheduled. Its visit adds the nodes that it needs.
    struct Visit {
        enum Kind { once, frame, gather, consume_all, consume } kind;
        std::size_t node, t = 0, pass = 0;
    };

    /// Schedules a node, and then the nodes that it needs, in depth-first order. It uses a list,
    /// since pipelines may be deeper than the program's stack.
    void work(const Visit& first) {
        later(first);
        while (!open_.empty()) {
            const auto [kind, node, t, pass] = open_.back();
            open_.pop_back();
            const auto before = static_cast<std::ptrdiff_t>(open_.size());
            switch (kind) {
                case Visit::once: once(node); break;
                case Visit::frame: frame(node, t, pass); break;
                case Visit::gather: gather(node); break;
                case Visit::consume_all: consume_all(node); break;
                case Visit::consume: consume(node, t); break;
            }
            std::reverse(open_.begin() + before, open_.end());
        }
    }

    void later(const Visit& visit) { open_.push_back(visit); }

    void once(std::size_t n) {
        auto& action = out_.once[n];
        if (action != Action::none) return;
        action = known_.result(n, 0) ? Action::load : Action::run;
        if (action == Action::load) return;
        checksummed(n);
        if (pipeline_.nodes[n].streams_in()) later({Visit::gather, n});
        else inputs(n, 0, 0);
    }

    void frame(std::size_t n, std::size_t t, std::size_t pass) {
        auto& action = out_.frames[pass][t].results[n];
        if (action != Action::none) return;
        action = known_.result(n, t) || kept_earlier(n, t, pass) ? Action::load : Action::run;
        if (action == Action::load) return;
        checksummed(n);
        if (pipeline_.nodes[n].streams_in()) later({Visit::gather, n});
        if (!pipeline_.nodes[n].retimes()) inputs(n, t, pass);
    }

    /// A writer states checksums of results upstream: it needs these results even if all its
    /// inputs are cached.
    void checksummed(std::size_t n) {
        for (const auto& link : pipeline_.nodes[n].checksummed) later({Visit::once, link.node});
    }

    bool kept_earlier(std::size_t n, std::size_t t, std::size_t pass) const {
        if (!earlier_kept_ || !pipeline_.nodes[n].kept || !known_.keeps(n, t)) return false;
        return std::any_of(
            out_.frames.begin(), out_.frames.begin() + static_cast<std::ptrdiff_t>(pass),
            [&](const auto& earlier) { return earlier[t].results[n] != Action::none; });
    }

    void gather(std::size_t n) {
        if (out_.gathers[n]) return;
        out_.gathers[n] = 1;
        later({Visit::consume_all, n});
        for (const auto& link : pipeline_.nodes[n].links())
            if (pipeline_.nodes[link.node].rate != Rate::frame) later({Visit::once, link.node});
    }

    void consume_all(std::size_t n) {
        for (std::size_t t = 0; t < delivered_.size(); ++t)
            if (known_.takes(n, t)) later({Visit::consume, n, t});
    }

    void consume(std::size_t n, std::size_t t) {
        const auto pass = plan_.gathered_in[n];
        auto& how = out_.frames[pass][t].consumes[n];
        if (how != Consume::none) return;
        how = known_.digest(n, t) ? Consume::digest : Consume::inputs;
        if (how == Consume::inputs) inputs(n, t, pass);
    }

    void inputs(std::size_t n, std::size_t t, std::size_t pass) {
        for (const auto& link : pipeline_.nodes[n].links()) {
            if (pipeline_.nodes[link.node].rate == Rate::frame)
                later({Visit::frame, link.node, t, pass});
            else later({Visit::once, link.node});
        }
    }

    const Pipeline& pipeline_;
    const Plan& plan_;
    const std::vector<bool>& delivered_;
    const ScheduleQueries& known_;
    Schedule out_;
    bool earlier_kept_ = false;
    std::vector<Visit> open_;  ///< the next one is the last
};

}  // namespace

bool Schedule::Frame::computes() const {
    return std::ranges::find(results, Action::run) != results.end() ||
           std::ranges::find(consumes, Consume::inputs) != consumes.end();
}

bool Schedule::Frame::empty() const {
    return std::ranges::all_of(results, [](Action action) { return action == Action::none; }) &&
           std::ranges::all_of(consumes, [](Consume how) { return how == Consume::none; });
}

Schedule make_schedule(const Pipeline& pipeline, const Plan& plan,
                       const std::vector<bool>& delivered, const ScheduleQueries& known) {
    return Scheduler(pipeline, plan, delivered, known).make();
}

std::vector<NodeWork> work_of(const Schedule& schedule) {
    std::vector<NodeWork> out(schedule.once.size());
    for (std::size_t n = 0; n < out.size(); ++n) {
        out[n].once = schedule.gathers[n] != 0 || schedule.once[n] == Action::run;
        out[n].loaded_results = schedule.once[n] == Action::load ? 1 : 0;
    }
    for (std::size_t n = 0; n < out.size(); ++n) {
        std::vector<bool> computed(schedule.frames.empty() ? 0 : schedule.frames.front().size());
        for (const auto& pass : schedule.frames)
            for (std::size_t t = 0; t < pass.size(); ++t) {
                const auto& frame = pass[t];
                if (frame.results[n] == Action::run) {
                    ++out[n].runs;
                    out[n].frames += computed[t] ? 0 : 1;
                    computed[t] = true;
                }
                out[n].consumed_inputs += frame.consumes[n] == Consume::inputs ? 1 : 0;
                out[n].consumed_digests += frame.consumes[n] == Consume::digest ? 1 : 0;
                out[n].loaded_results += frame.results[n] == Action::load ? 1 : 0;
            }
    }
    return out;
}

NodeFrames working_frames(const Schedule& schedule, std::size_t n) {
    NodeFrames out;
    for (const auto& pass : schedule.frames)
        for (std::size_t t = 0; t < pass.size(); ++t) {
            if (pass[t].results[n] == Action::run) out.run.insert(t);
            if (pass[t].consumes[n] == Consume::inputs) out.consumed_inputs.insert(t);
            if (pass[t].consumes[n] == Consume::digest) out.consumed_digests.insert(t);
        }
    return out;
}

std::vector<NodeDemand> demands_of(const Pipeline& pipeline, const Plan& plan,
                                   const Schedule& schedule, const Schedule& uncached) {
    std::vector<NodeDemand> out(pipeline.nodes.size());
    for (std::size_t n = 0; n < out.size(); ++n) {
        const auto& node = pipeline.nodes[n];
        const auto now = working_frames(schedule, n), anew = working_frames(uncached, n);
        auto& demand = out[n];
        demand.consumed_inputs = now.consumed_inputs.size();
        demand.consumed_digests = now.consumed_digests.size();
        if (plan.digested[n]) {
            demand.needed = anew.consumed_inputs.size();
            demand.computed = demand.consumed_inputs;
            demand.only_digests = true;
        } else if (node.rate == Rate::frame) {
            demand.needed = anew.run.size();
            demand.computed = now.run.size();
        } else if (uncached.once[n] == Action::run) {
            demand.needed = node.streams_in() ? anew.consumed_inputs.size() : 1;
            demand.computed = schedule.once[n] == Action::run ? demand.needed : 0;
        }
    }
    return out;
}

}  // namespace fluidcarve
