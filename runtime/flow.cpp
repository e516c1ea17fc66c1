#include "runtime/flow.h"

#include <fmt/format.h>
#include <tbb/flow_graph.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <mutex>
#include <new>
#include <set>

namespace fluidcarve {
namespace {

using Clock = std::chrono::steady_clock;
double since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// One frame on its way through a pass. Nodes of the pass fire when their last input has arrived.
struct FrameRun {
    FrameRun(std::size_t place, std::size_t order, std::size_t nodes)
        : place(place), order(order), outputs(nodes), waiting(nodes), readers(nodes), active(nodes), failed(nodes) {}

    const std::size_t place;  ///< in the sequence
    const std::size_t order;  ///< of admission, without gaps
    std::vector<std::vector<Payload>> outputs;
    std::vector<std::atomic<int>> waiting;  ///< inputs still to arrive
    std::vector<std::atomic<int>> readers;  ///< nodes that have yet to read the outputs
    std::vector<char> active;               ///< the node has work in this frame
    std::vector<char> failed;
    std::atomic<int> open{0};  ///< ends of the graph not yet reached
};
using Token = std::shared_ptr<FrameRun>;

/// The edges of one pass, between pipeline nodes.
struct Wiring {
    std::vector<std::size_t> units;                 ///< per-frame nodes, then gatherers
    std::vector<std::vector<std::size_t>> sources;  ///< per pipeline node: units that it reads
    std::vector<std::vector<std::size_t>> readers;  ///< per pipeline node: units that read it
};

Wiring wire(const Pipeline& pipeline, const Pass& pass) {
    Wiring out;
    out.units = pass.per_frame;
    out.units.insert(out.units.end(), pass.gatherers.begin(), pass.gatherers.end());
    out.sources.resize(pipeline.nodes.size());
    out.readers.resize(pipeline.nodes.size());
    for (const auto unit : out.units) {
        std::set<std::size_t> distinct;
        for (const auto& links : pipeline.nodes[unit].inputs)
            for (const auto& link : links)
                if (pipeline.nodes[link.node].rate == Rate::frame) distinct.insert(link.node);
        for (const auto source : distinct) {
            out.sources[unit].push_back(source);
            out.readers[source].push_back(unit);
        }
    }
    return out;
}

}  // namespace

struct Flow::Self {
    /// One node's line to the run.
    struct NodeHost : Context::Host {
        Self* run = nullptr;
        std::size_t node = 0;
        Clock::time_point finish_start{};
        bool cancelled() const override { return run->cancelled(); }
        void warn(const std::string& message) override { run->report.warn(node, message); }
        void report(const std::string& section, const nlohmann::ordered_json& entry) override { run->report.entry(node, section, entry); }
        void progress(double fraction) override {
            if (run->steps[node].finish) run->progress.part(*run->steps[node].finish, fraction, since(finish_start));
        }
    };
    struct Steps {
        std::optional<std::size_t> run, add, finish;
    };

    const Pipeline& pipeline;
    const Registry& registry;
    const std::vector<int>& frames;
    const RunOptions& options;
    Report& report;
    Progress& progress;
    const std::function<bool()> cancelled;
    std::vector<Behaviour> behaviours;
    std::vector<NodeHost> hosts;
    std::vector<Steps> steps;
    std::vector<std::vector<Payload>> held;  ///< outputs of once-run nodes
    std::atomic<bool> failed{false};         ///< something went wrong
    std::atomic<bool> fatal{false};          ///< it ends the run even where the user said to keep going

    bool stopped() const { return cancelled() || fatal || (failed && !options.keep_going); }

    Context context(std::size_t node) {
        Context out(hosts[node], frames);
        out.limits(options.memory, options.work_folder);
        return out;
    }

    /// Hands a node its inputs. @param frame  null: per-frame inputs stay empty
    void connect(std::size_t n, void* ports, const FrameRun* frame) const {
        const auto& node = pipeline.nodes[n];
        for (std::size_t i = 0; i < node.inputs.size(); ++i) {
            const auto& spec = node.type->inputs[i];
            std::vector<Payload> in;
            for (const auto& link : node.inputs[i]) {
                const auto& source = pipeline.nodes[link.node];
                const bool per_frame = source.rate == Rate::frame;
                if (per_frame && !frame) continue;
                const auto& payload = (per_frame ? frame->outputs : held)[link.node][link.output];
                if (!payload) throw Failure(fmt::format("input '{}' got nothing from {}.{}", spec.name, source.name, source.outputs[link.output].name));
                in.push_back(registry.convert(payload, spec.type));
            }
            spec.set(ports, in, node.input_names[i]);
        }
    }

    std::vector<Payload> collect(std::size_t n, const void* ports) const {
        std::vector<Payload> out;
        for (const auto& output : pipeline.nodes[n].outputs) out.push_back(output.get(ports));
        return out;
    }

    std::uint64_t bytes(const std::vector<Payload>& payloads) const {
        std::uint64_t out = 0;
        for (const auto& payload : payloads)
            if (payload) out += registry.payload(payload.type()).bytes(payload);
        return out;
    }

    /// Calls a body; whatever it throws becomes a Fault. No exception leaves: one would cancel the whole graph.
    bool guarded(std::size_t n, std::optional<int> frame, const std::function<void()>& body) {
        const auto fault = [&](const std::string& message, Failure::Kind kind) {
            report.failed({pipeline.nodes[n].name, pipeline.nodes[n].type->name, frame, message, kind});
            failed = true;
            return false;
        };
        try {
            // Isolated: a parallel loop inside the body must not pick up another frame's body while it waits.
            tbb::this_task_arena::isolate(body);
            return true;
        } catch (const Cancelled&) {
            return false;
        } catch (const Failure& failure) {
            return fault(failure.what(), failure.kind);
        } catch (const std::bad_alloc&) {
            return fault("out of memory; try a smaller --in-flight", Failure::Kind::data);
        } catch (const std::exception& error) {
            return fault(error.what(), Failure::Kind::data);
        }
    }

    bool finish(std::size_t n) {
        const auto start = hosts[n].finish_start = Clock::now();
        const bool good = guarded(n, std::nullopt, [&] {
            auto ports = behaviours[n].make_ports();
            connect(n, ports.get(), nullptr);
            auto where = context(n);
            behaviours[n].finish(ports.get(), where);
            if (pipeline.nodes[n].rate != Rate::frame) held[n] = collect(n, ports.get());
        });
        report.ran(n, 0, since(start), bytes(held[n]));
        progress.done(*steps[n].finish, since(start), std::nullopt);
        if (!good) fatal = true;
        return good;
    }

    void once(std::size_t n) {
        const auto& node = pipeline.nodes[n];
        const auto& behaviour = behaviours[n];
        const bool connected = std::any_of(node.inputs.begin(), node.inputs.end(), [](const auto& links) { return !links.empty(); });
        const auto start = Clock::now();
        const bool good = guarded(n, std::nullopt, [&] {
            auto ports = behaviour.make_ports();
            connect(n, ports.get(), nullptr);
            auto where = context(n);
            if (behaviour.add && connected) behaviour.add(ports.get(), where);
            if (behaviour.finish) behaviour.finish(ports.get(), where);
            if (behaviour.run) behaviour.run(ports.get(), where);
            held[n] = collect(n, ports.get());
        });
        report.ran(n, 1, since(start), bytes(held[n]));
        progress.done(*steps[n].run, since(start), std::nullopt);
        if (!good) fatal = true;
    }

    /// A per-frame node's work in one frame.
    void run(std::size_t n, FrameRun& frame, const Wiring& wiring, bool target) {
        const bool upstream_failed = std::any_of(wiring.sources[n].begin(), wiring.sources[n].end(), [&](std::size_t source) { return frame.failed[source]; });
        if (frame.active[n] && (upstream_failed || cancelled())) {
            frame.failed[n] = true;
        } else if (frame.active[n]) {
            const auto& node = pipeline.nodes[n];
            const auto wants = [&](std::string_view output) {
                for (const auto reader : wiring.readers[n]) {
                    if (!frame.active[reader]) continue;
                    for (const auto& links : pipeline.nodes[reader].inputs)
                        for (const auto& link : links)
                            if (link.node == n && node.outputs[link.output].name == output) return true;
                }
                return target;
            };
            const auto start = Clock::now();
            frame.failed[n] = !guarded(n, frames[frame.place], [&] {
                auto ports = behaviours[n].make_ports();
                connect(n, ports.get(), &frame);
                auto where = context(n);
                where.at(frame.place).wanting(wants);
                behaviours[n].run(ports.get(), where);
                frame.outputs[n] = collect(n, ports.get());
            });
            report.ran(n, 1, since(start), bytes(frame.outputs[n]));
            progress.done(*steps[n].run, since(start), frames[frame.place]);
        }
        release(n, frame, wiring);
    }

    /// A gatherer takes one frame; false if the frame had failed.
    bool add(std::size_t n, FrameRun& frame, const Wiring& wiring) {
        bool good = true;
        if (frame.active[n]) {
            good = !cancelled() && std::none_of(wiring.sources[n].begin(), wiring.sources[n].end(), [&](std::size_t source) { return frame.failed[source]; });
            const auto start = Clock::now();
            good = good && guarded(n, frames[frame.place], [&] {
                       auto ports = behaviours[n].make_ports();
                       connect(n, ports.get(), &frame);
                       auto where = context(n);
                       where.at(frame.place);
                       behaviours[n].add(ports.get(), where);
                   });
            report.ran(n, 1, since(start), 0);
            progress.done(*steps[n].add, since(start), frames[frame.place]);
        }
        release(n, frame, wiring);
        return good;
    }

    /// Lets go of what this node was the last to read: not the whole frame stays alive until its end.
    static void release(std::size_t n, FrameRun& frame, const Wiring& wiring) {
        for (const auto source : wiring.sources[n])
            if (frame.readers[source].fetch_sub(1) == 1) frame.outputs[source].clear();
        if (wiring.readers[n].empty()) frame.outputs[n].clear();
    }

    /// Which nodes work in a frame of a pass.
    std::vector<char> active_in(const Pass& pass, std::size_t place, bool delivered) {
        std::vector<char> out(pipeline.nodes.size(), 0);
        const auto mark = [&](const std::vector<bool>& flags) {
            for (std::size_t n = 0; n < out.size(); ++n) out[n] = out[n] || flags[n];
        };
        if (delivered) mark(pass.delivery_needs);
        for (std::size_t g = 0; g < pass.gatherers.size(); ++g) {
            const auto n = pass.gatherers[g];
            auto where = context(n);
            if (behaviours[n].wants && !behaviours[n].wants(where.at(place))) continue;
            mark(pass.gatherer_needs[g]);
            out[n] = true;
        }
        return out;
    }

    std::vector<std::vector<char>> active_frames(const Pass& pass, const std::vector<bool>& delivered) {
        std::vector<std::vector<char>> out;
        for (std::size_t place = 0; place < frames.size(); ++place) out.push_back(active_in(pass, place, delivered[place]));
        return out;
    }
};

Flow::Flow(const Pipeline& pipeline, const Registry& registry, const std::vector<int>& frames, const RunOptions& options, Report& report, Progress& progress,
           std::function<bool()> cancelled)
    : self_(new Self{pipeline, registry, frames, options, report, progress, std::move(cancelled), {}, {}, {}, {}, {}, {}}) {
    const auto count = pipeline.nodes.size();
    self_->hosts.resize(count);
    self_->steps.resize(count);
    self_->held.resize(count);
    for (std::size_t n = 0; n < count; ++n) {
        self_->behaviours.push_back(pipeline.nodes[n].type->bind(pipeline.nodes[n].params));
        self_->hosts[n].run = self_.get();
        self_->hosts[n].node = n;
    }
}

Flow::~Flow() = default;

bool Flow::stopped() const { return self_->stopped(); }

void Flow::announce(const Plan& plan, const std::vector<bool>& delivered) {
    const auto& pipeline = self_->pipeline;
    auto& progress = self_->progress;
    auto& steps = self_->steps;
    std::vector<std::size_t> runs(pipeline.nodes.size(), 0);
    for (const auto& pass : plan.passes) {
        for (const auto n : pass.before) ++runs[n];
        std::vector<std::size_t> adds(pipeline.nodes.size(), 0);
        for (const auto& active : self_->active_frames(pass, delivered)) {
            for (const auto n : pass.per_frame) runs[n] += active[n] ? 1 : 0;
            for (const auto n : pass.gatherers) adds[n] += active[n] ? 1 : 0;
        }
        for (const auto n : pass.gatherers) {
            steps[n].add = progress.add({pipeline.nodes[n].name, adds[n]});
            steps[n].finish = progress.add({pipeline.nodes[n].name, 1});
        }
    }
    for (const auto n : plan.after) ++runs[n];
    for (std::size_t n = 0; n < runs.size(); ++n)
        if (runs[n] > 0) steps[n].run = progress.add({pipeline.nodes[n].name, runs[n]});
}

void Flow::run_once(const std::vector<std::size_t>& nodes) {
    for (const auto n : nodes)
        if (!stopped()) self_->once(n);
}

void Flow::run_pass(const Pass& pass, const std::vector<bool>& delivered, const std::vector<bool>& targets) {
    namespace flow = tbb::flow;
    auto& self = *self_;
    const auto wiring = wire(self.pipeline, pass);
    const auto nodes = self.pipeline.nodes.size();
    const auto active = self.active_frames(pass, delivered);
    std::vector<std::size_t> places;
    for (std::size_t place = 0; place < active.size(); ++place)
        if (std::find(active[place].begin(), active[place].end(), 1) != active[place].end()) places.push_back(place);

    flow::graph graph;
    std::size_t next = 0;
    // Only numbers wait in front of the limiter; data comes to life behind it.
    flow::input_node<std::size_t> source(graph, [&](tbb::flow_control& control) -> std::size_t {
        if (next == places.size() || self.stopped()) return control.stop(), 0;
        return next++;
    });
    flow::limiter_node<std::size_t> limiter(graph, static_cast<std::size_t>(std::max(1, self.options.in_flight)));
    int ends = 0;
    for (const auto unit : wiring.units) ends += wiring.readers[unit].empty() ? 1 : 0;
    flow::function_node<std::size_t, Token> admit(graph, flow::unlimited, [&](std::size_t order) {
        auto frame = std::make_shared<FrameRun>(places[order], order, nodes);
        frame->active = active[places[order]];
        frame->open = ends;
        for (const auto unit : wiring.units) {
            frame->waiting[unit] = static_cast<int>(std::max<std::size_t>(1, wiring.sources[unit].size()));
            frame->readers[unit] = static_cast<int>(wiring.readers[unit].size());
        }
        return frame;
    });
    flow::function_node<Token, flow::continue_msg> retire(graph, flow::unlimited, [&](const Token& frame) {
        if (frame->open.fetch_sub(1) == 1) limiter.decrementer().try_put(flow::continue_msg{});
        return flow::continue_msg{};
    });
    flow::make_edge(source, limiter);
    flow::make_edge(limiter, admit);

    using Unit = flow::multifunction_node<Token, std::tuple<Token>>;
    struct Gather {
        std::unique_ptr<flow::sequencer_node<Token>> order;
        std::unique_ptr<flow::function_node<Token, Token>> add;
        std::vector<int> lost;  ///< frames that failed upstream or here
    };
    std::vector<std::unique_ptr<Unit>> units(nodes);
    std::vector<Gather> gathers(nodes);
    for (const auto n : wiring.units) {
        const bool gathers_here = std::find(pass.gatherers.begin(), pass.gatherers.end(), n) != pass.gatherers.end();
        units[n] =
            std::make_unique<Unit>(graph, flow::unlimited, [&self, &wiring, &targets, n, gathers_here](const Token& frame, Unit::output_ports_type& out) {
                if (frame->waiting[n].fetch_sub(1) != 1) return;
                if (!gathers_here) self.run(n, *frame, wiring, targets[n]);
                std::get<0>(out).try_put(frame);
            });
        if (!gathers_here) continue;
        auto& gather = gathers[n];
        // Every admitted frame passes, failed ones too: a gap would stall the sequencer for good.
        gather.order = std::make_unique<flow::sequencer_node<Token>>(graph, [](const Token& frame) { return frame->order; });
        gather.add = std::make_unique<flow::function_node<Token, Token>>(graph, flow::serial, [&self, &wiring, &gather, n](const Token& frame) {
            if (!self.add(n, *frame, wiring)) gather.lost.push_back(self.frames[frame->place]);
            return frame;
        });
        flow::make_edge(flow::output_port<0>(*units[n]), *gather.order);
        flow::make_edge(*gather.order, *gather.add);
        flow::make_edge(*gather.add, retire);
    }
    for (const auto n : wiring.units) {
        if (wiring.sources[n].empty()) flow::make_edge(admit, *units[n]);
        for (const auto reader : wiring.readers[n]) flow::make_edge(flow::output_port<0>(*units[n]), *units[reader]);
        if (wiring.readers[n].empty() && !gathers[n].add) flow::make_edge(flow::output_port<0>(*units[n]), retire);
    }
    source.activate();
    graph.wait_for_all();

    for (const auto n : pass.gatherers) {
        if (self.stopped()) return;
        if (gathers[n].lost.empty()) {
            self.finish(n);
            continue;
        }
        const auto& node = self.pipeline.nodes[n];
        self.report.failed({node.name, node.type->name, std::nullopt,
                            fmt::format("needs every frame of the sequence, but these failed: {}", FrameSet(gathers[n].lost).text()), Failure::Kind::data});
        self.failed = self.fatal = true;
    }
}

}  // namespace fluidcarve
