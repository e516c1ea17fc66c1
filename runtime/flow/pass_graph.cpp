#include "runtime/flow/pass_graph.h"

#include <algorithm>

namespace fluidcarve {

namespace flow = tbb::flow;

std::vector<std::size_t> PassGraph::indices_of(const std::vector<Schedule::Frame>& frames) {
    std::vector<std::size_t> out;
    for (std::size_t t = 0; t < frames.size(); ++t)
        if (!frames[t].empty()) out.push_back(t);
    return out;
}

PassGraph::PassGraph(const FlowSetup& setup, BodyCalls& bodies, CachedResults& results,
                     const ScheduledPass& pass)
    : setup_(setup),
      bodies_(bodies),
      pass_(pass.plan.passes[pass.number]),
      plan_(pass.plan),
      schedule_(pass.schedule),
      frames_(pass.schedule.frames[pass.number]),
      indices_(indices_of(frames_)),
      wiring_(wire(setup.pipeline, pass_)),
      calls_(setup, bodies, results, wiring_),
      ahead_(files_of(setup.store, wiring_, frames_, indices_),
             static_cast<std::size_t>(setup.options.in_flight), setup.options.memory),
      // Only numbers wait in front of the limiter. Frames are created behind it.
      source_(graph_,
              [this](tbb::flow_control& control) -> std::size_t {
                  if (next_ == indices_.size() || calls_.stopped()) return control.stop(), 0;
                  return next_++;
              }),
      limiter_(graph_, static_cast<std::size_t>(std::max(1, setup.options.in_flight))),
      admit_(graph_, flow::unlimited, [this](std::size_t order) { return admit(order); }),
      retire_(graph_, flow::unlimited,
              [this](const Frame& frame) { return retire(*frame), flow::continue_msg{}; }),
      units_(setup.pipeline.nodes.size()),
      gathering_(units_.size()) {
    flow::make_edge(source_, limiter_);
    flow::make_edge(limiter_, admit_);
    for (const auto n : wiring_.units) add_unit(n);
    for (const auto n : wiring_.units) connect(n);
}

PassGraph::~PassGraph() {
    // After an exception, something may still run.
    graph_.cancel();
    graph_.wait_for_all();
}

ConsumedFrames PassGraph::stream() {
    source_.activate();
    graph_.wait_for_all();
    return calls_.consumed();
}

PassGraph::Frame PassGraph::admit(std::size_t order) {
    ++bodies_.in_flight;
    ahead_.begin(order);
    auto frame = std::make_shared<FrameRun>(indices_[order], order, frames_[indices_[order]]);
    frame->open = ends_;
    for (const auto unit : wiring_.units) {
        frame->waiting[unit] =
            static_cast<int>(std::max<std::size_t>(1, wiring_.sources[unit].size()));
        frame->readers[unit] = static_cast<int>(wiring_.readers[unit].size());
    }
    return frame;
}

void PassGraph::retire(FrameRun& frame) {
    if (frame.open.fetch_sub(1) != 1) return;
    --bodies_.in_flight;
    ahead_.end(frame.order);
    if (frame.scheduled.computes()) setup_.events.passed(setup_.timelines.frames()[frame.t]);
    limiter_.decrementer().try_put(flow::continue_msg{});
}

bool PassGraph::gathers(std::size_t n) const {
    return std::ranges::find(pass_.gathering, n) != pass_.gathering.end();
}

void PassGraph::work(std::size_t n, FrameRun& frame) {
    if (gathers(n)) calls_.digest(n, frame);
    else calls_.run(n, frame, plan_.targets[n]);
}

void PassGraph::add_unit(std::size_t n) {
    units_[n] = std::make_unique<Unit>(graph_, flow::unlimited,
                                       [this, n](const Frame& frame, Unit::output_ports_type& out) {
                                           if (frame->waiting[n].fetch_sub(1) != 1) return;
                                           work(n, *frame);
                                           std::get<0>(out).try_put(frame);
                                       });
    if (gathers(n)) add_gathering(n);
    if (wiring_.readers[n].empty()) ++ends_;
}

void PassGraph::add_gathering(std::size_t n) {
    auto& [order, consume] = gathering_[n];
    // Every admitted frame must pass, also a failed one: a gap would block the sequencer forever.
    order = std::make_unique<flow::sequencer_node<Frame>>(
        graph_, [](const Frame& frame) { return frame->order; });
    consume = std::make_unique<flow::function_node<Frame, Frame>>(
        graph_, flow::serial, [this, n](const Frame& frame) {
            calls_.consume(n, *frame, schedule_.gathers[n] != 0);
            return frame;
        });
    flow::make_edge(flow::output_port<0>(*units_[n]), *order);
    flow::make_edge(*order, *consume);
    flow::make_edge(*consume, retire_);
}

void PassGraph::connect(std::size_t n) {
    if (wiring_.sources[n].empty()) flow::make_edge(admit_, *units_[n]);
    for (const auto reader : wiring_.readers[n])
        flow::make_edge(flow::output_port<0>(*units_[n]), *units_[reader]);
    if (wiring_.readers[n].empty() && !gathers(n))
        flow::make_edge(flow::output_port<0>(*units_[n]), retire_);
}

}  // namespace fluidcarve
