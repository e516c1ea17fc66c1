#include "runtime/run/flow.h"

#include "carve/base/frame_set.h"
#include "runtime/plan/frame_run.h"
#include "runtime/run/end_of_graph.h"
#include "runtime/run/flow_self.h"
#include "runtime/run/ports.h"
#include "runtime/run/read_ahead.h"

#include <fmt/format.h>
#include <tbb/flow_graph.h>

#include <algorithm>

namespace fluidcarve {

Flow::Flow(const Pipeline& pipeline, const Registry& registry, const Timelines& timelines,
           const RunOptions& options, Store& store, InputGuard& guard, Report& report,
           Progress& progress, WorkTimes& costs, RunProfile* profile,
           std::function<bool()> cancelled)
    : self_(new Self{pipeline, registry, timelines, options, store, guard, report, progress, costs,
                     profile, std::move(cancelled)}) {
    for (const auto& node : pipeline.nodes)
        self_->behaviours.push_back(node.type->bind(node.params));
}

Flow::~Flow() = default;

bool Flow::stopped() const { return self_->stopped(); }

bool Flow::lost() const { return self_->lost; }

/// Registers everything that will run with the progress display.
void Flow::Self::announce(const Schedule& schedule) {
    all_calls = calls_of(schedule);
    progress.begin_again();
    const auto step = [&](std::size_t n, std::size_t runs, Work work) {
        return runs > 0 ? std::optional(
                              progress.add({pipeline.nodes[n].name, runs, costs.expected(n, work)}))
                        : std::nullopt;
    };
    for (std::size_t n = 0; n < all_calls.size(); ++n) {
        const auto& calls = all_calls[n];
        const bool finishes = schedule.gathers[n] != 0;
        steps[n].add = step(n, calls.takes, Work::take);
        steps[n].finish = step(n, finishes ? 1 : 0, Work::once);
        steps[n].run = calls.runs > 0 ? step(n, calls.runs, Work::frame)
                                      : step(n, calls.once && !finishes ? 1 : 0, Work::once);
    }
}

void Flow::run(const Plan& plan, const Schedule& schedule) {
    auto& self = *self_;
    self.announce(schedule);
    for (std::size_t p = 0; p < plan.passes.size() && !self.stopped(); ++p) {
        self.progress.begin_pass(p);
        self.run_once(plan.passes[p].before, plan, schedule);
        if (!self.stopped()) self.run_pass(p, plan, schedule);
    }
    if (!self.stopped()) self.run_once(plan.after, plan, schedule);
}

/// Streams the frames through one pass.
void Flow::Self::run_pass(std::size_t p, const Plan& plan, const Schedule& schedule) {
    namespace flow = tbb::flow;
    auto& self = *this;
    const auto& pass = plan.passes[p];
    const auto& frames_of_pass = schedule.frames[p];
    const auto wiring = wire(self.pipeline, pass);
    std::vector<std::size_t> places;
    for (std::size_t place = 0; place < frames_of_pass.size(); ++place)
        if (!frames_of_pass[place].empty()) places.push_back(place);
    auto [read, written] = files_of(self.store, wiring, frames_of_pass, places);
    ReadAhead ahead(std::move(read), std::move(written),
                    static_cast<std::size_t>(self.options.in_flight), self.options.memory);
    flow::graph graph;
    std::size_t next = 0;
    // Only numbers wait in front of the limiter. Frames are created behind it.
    flow::input_node<std::size_t> source(graph, [&](tbb::flow_control& control) -> std::size_t {
        if (next == places.size() || self.stopped()) return control.stop(), 0;
        return next++;
    });
    flow::limiter_node<std::size_t> limiter(
        graph, static_cast<std::size_t>(std::max(1, self.options.in_flight)));
    int ends = 0;
    for (const auto unit : wiring.units) ends += wiring.readers[unit].empty() ? 1 : 0;
    flow::function_node<std::size_t, Token> admit(graph, flow::unlimited, [&](std::size_t order) {
        ++self.in_flight;
        ahead.begin(order);
        auto frame =
            std::make_shared<FrameRun>(places[order], order, frames_of_pass[places[order]]);
        frame->open = ends;
        for (const auto unit : wiring.units) {
            frame->waiting[unit] =
                static_cast<int>(std::max<std::size_t>(1, wiring.sources[unit].size()));
            frame->readers[unit] = static_cast<int>(wiring.readers[unit].size());
        }
        return frame;
    });
    flow::function_node<Token, flow::continue_msg> retire(
        graph, flow::unlimited, [&](const Token& frame) {
            if (frame->open.fetch_sub(1) == 1) {
                --self.in_flight;
                ahead.end(frame->order);
                if (frame->scheduled.computes()) self.progress.passed(self.frames[frame->place]);
                limiter.decrementer().try_put(flow::continue_msg{});
            }
            return flow::continue_msg{};
        });
    flow::make_edge(source, limiter);
    flow::make_edge(limiter, admit);
    using Unit = flow::multifunction_node<Token, std::tuple<Token>>;
    struct Gather {
        std::unique_ptr<flow::sequencer_node<Token>> order;
        std::unique_ptr<flow::function_node<Token, Token>> add;
        std::vector<int> lost;  ///< numbers of the frames that failed upstream or here
    };
    std::vector<std::unique_ptr<Unit>> units(self.pipeline.nodes.size());
    std::vector<Gather> gathers(units.size());
    for (const auto n : wiring.units) {
        const bool gathers_here =
            std::find(pass.gatherers.begin(), pass.gatherers.end(), n) != pass.gatherers.end();
        units[n] = std::make_unique<Unit>(graph, flow::unlimited,
                                          [&self, &wiring, &plan, n, gathers_here](
                                              const Token& frame, Unit::output_ports_type& out) {
                                              if (frame->waiting[n].fetch_sub(1) != 1) return;
                                              if (gathers_here) self.digest(n, *frame, wiring);
                                              else self.run(n, *frame, wiring, plan.targets[n]);
                                              std::get<0>(out).try_put(frame);
                                          });
        if (!gathers_here) continue;
        auto& gather = gathers[n];
        // Every admitted frame must pass, also a failed one: a gap would block the sequencer
        // forever.
        gather.order = std::make_unique<flow::sequencer_node<Token>>(
            graph, [](const Token& frame) { return frame->order; });
        gather.add = std::make_unique<flow::function_node<Token, Token>>(
            graph, flow::serial, [&self, &wiring, &gather, &schedule, n](const Token& frame) {
                if (!self.add(n, *frame, wiring, schedule.gathers[n] != 0))
                    gather.lost.push_back(self.frames[frame->place]);
                return frame;
            });
        flow::make_edge(flow::output_port<0>(*units[n]), *gather.order);
        flow::make_edge(*gather.order, *gather.add);
        flow::make_edge(*gather.add, retire);
    }
    for (const auto n : wiring.units) {
        if (wiring.sources[n].empty()) flow::make_edge(admit, *units[n]);
        for (const auto reader : wiring.readers[n])
            flow::make_edge(flow::output_port<0>(*units[n]), *units[reader]);
        if (wiring.readers[n].empty() && !gathers[n].add)
            flow::make_edge(flow::output_port<0>(*units[n]), retire);
    }
    const EndOfGraph end(graph);
    source.activate();
    graph.wait_for_all();

    for (const auto n : pass.gatherers) {
        if (self.stopped()) return;
        if (schedule.once[n] == Action::load) self.load_once(n);
        if (!schedule.gathers[n]) continue;
        if (gathers[n].lost.empty()) {
            self.finish(n);
            continue;
        }
        const auto& node = self.pipeline.nodes[n];
        self.report.failed({node.name, node.type->name, std::nullopt,
                            fmt::format("needs every frame of the sequence, but these failed: {}",
                                        FrameSet(gathers[n].lost).text()),
                            Failure::Kind::data});
        self.failed = self.fatal = true;
    }
}

}  // namespace fluidcarve
