#include "runtime/run/flow.h"

#include "runtime/plan/frame_run.h"
#include "runtime/run/end_of_graph.h"
#include "runtime/run/file_provenance.h"
#include "runtime/run/out_of_memory.h"
#include "runtime/run/ports.h"
#include "runtime/run/read_ahead.h"

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

using Token = std::shared_ptr<FrameRun>;
using Action = Schedule::Action;
using Take = Schedule::Take;

}  // namespace

struct Flow::Self {
    /// The Context::Host of one call of a body. Forwards messages to the run, and records them for the cache.
    struct Line : Context::Host {
        Line(Self& run, std::size_t node) : run(run), node(node), span(run.costs) {}
        Self& run;
        const std::size_t node;
        const Clock::time_point start = Clock::now();
        WorkTimes::Span span;
        std::atomic<double> fraction{0};  ///< of the work of `finish`
        Extent found{}, before{};         ///< of a growing result: what is kept, and what an earlier run had found
        std::mutex mutex;
        Said said;
        bool grows = false;  ///< `hold` caches what there is of a growing result
        Clock::time_point next_hold{};

        bool cancelled() const override { return run.cancelled(); }
        void warn(const std::string& message) override {
            run.report.warn(node, message);
            const std::lock_guard lock(mutex);
            said.warnings.push_back(message);
        }
        void warn_at_once(const std::string& message) override {
            if (const auto line = run.report.warn(node, message); !line.empty()) run.progress.say(line);
            warn(message);
        }
        void report(const std::string& section, const nlohmann::ordered_json& entry) override {
            run.report.entry(node, section, entry);
            const std::lock_guard lock(mutex);
            said.report[section] = entry;
        }
        Provenance provenance() const override { return run.provenance.of(node); }
        void progress(double share) override {
            fraction = share;
            if (run.steps[node].finish) run.progress.part(*run.steps[node].finish, share, since(start));
        }
        void hold(const Payload& result) override {
            const std::lock_guard lock(mutex);
            const auto begin = Clock::now();
            if (!grows || begin < next_hold) return;
            const RunProfile::Span span(run.profile, "keep", node, std::nullopt);
            run.store.keep_grown(node, 0, result, said, true);
            grew(of().type->growth->extent(result));
            // Wait ten times as long as the write took, so that writing takes at most a tenth of the time.
            constexpr int pauses = 10;
            next_hold = Clock::now() + pauses * (Clock::now() - begin);
        }
        void grew(const Extent& extent) {
            found = extent;
            run.report.grew(node, extent.count, wanted());
        }
        std::size_t wanted() const { return of().type->growth->wanted(of().params.get(), found.of); }
        const Node& of() const { return run.pipeline.nodes[node]; }
    };
    struct Steps {
        std::optional<std::size_t> run, add, finish;
    };

    const Pipeline& pipeline;
    const Registry& registry;
    const Timelines& timelines;
    const RunOptions& options;
    Store& store;
    InputGuard& guard;
    Report& report;
    Progress& progress;
    WorkTimes& costs;
    RunProfile* const profile;
    const std::function<bool()> cancelled;
    const std::vector<int>& frames = timelines.frames();
    const PortsOf io{pipeline, registry};
    std::vector<Behaviour> behaviours{};
    std::vector<Steps> steps = std::vector<Steps>(pipeline.nodes.size());
    std::vector<Calls> all_calls{};                                                                     ///< per node
    std::vector<std::size_t> gathered = std::vector<std::size_t>(pipeline.nodes.size());                ///< per node: frames that it has taken
    std::vector<std::vector<Payload>> held = std::vector<std::vector<Payload>>(pipeline.nodes.size());  ///< `[node][output]`: outputs of nodes that run once
    std::vector<std::set<std::size_t>> readers = io.readers();                                          ///< per node: those that may still read what it holds
    std::atomic<bool> failed{false};                                                                    ///< a body failed
    std::atomic<bool> fatal{false};                                                                     ///< the failure ends the run even with `keep_going`
    std::atomic<bool> lost{false};                                                                      ///< a cached result is missing
    std::atomic<std::size_t> in_flight{0};                                                              ///< frames
    FileProvenance provenance{pipeline, registry, held};

    bool stopped() const { return cancelled() || fatal || lost || (failed && !options.keep_going); }

    /// Whether a node makes its outputs of a frame, and does not take the frame.
    static bool delivers(std::size_t n, const FrameRun* frame) { return frame && frame->scheduled.results[n] == Action::run; }

    Context context(Line& line, const FrameRun* frame) {
        const auto& [numbers, index] = delivers(line.node, frame) ? timelines.delivered(line.node) : timelines.taken(line.node);
        auto out = Context(line, numbers).limits(options.memory, options.work_folder);
        return frame ? out.at(index.at(frame->place).value()) : out;
    }

    /// Calls a body and turns exceptions into Faults. An exception that escaped would cancel the whole flow graph.
    /// @param what  category in the profile
    /// @return false if the body threw
    bool guarded(std::size_t n, std::optional<int> frame, const char* what, const std::function<void()>& body) {
        const RunProfile::Span span(profile, what, n, frame);
        const auto fault = [&](const std::string& message, Failure::Kind kind) {
            report.failed({pipeline.nodes[n].name, pipeline.nodes[n].type->name, frame, message, kind});
            failed = true;
            return false;
        };
        try {
            // Isolate the body: a thread that waits in a parallel loop of the body must not start the body of another frame.
            tbb::this_task_arena::isolate(body);
            return true;
        } catch (const Cancelled&) {
            return false;
        } catch (const Failure& failure) {
            return fault(failure.what(), failure.kind);
        } catch (const std::bad_alloc&) {
            return fault(out_of_memory(what, in_flight, memory_now()), Failure::Kind::data);
        } catch (const std::exception& error) {
            return fault(error.what(), Failure::Kind::data);
        }
    }

    /// Calls a body with connected ports and a context.
    /// @param frame  null: a body that is called once
    bool call(Line& line, const FrameRun* frame, const char* what, const std::function<void(void* ports, Context&)>& body) {
        return guarded(line.node, frame ? std::optional(frames[frame->place]) : std::nullopt, what, [&] {
            const auto ports = behaviours[line.node].make_ports();
            const bool inputs = frame && !(delivers(line.node, frame) && line.of().retimes());  // it has taken their frames before
            io.connect(line.node, ports.get(), held, inputs ? &frame->outputs : nullptr);
            auto where = context(line, frame);
            guard.read(store.inputs(line.node, frame ? frame->place : 0), [&] { body(ports.get(), where); });
        });
    }

    /// Reports the end of a body that is called once, and keeps what it held. A failure there ends the run.
    void end_once(Line& line, std::size_t step, bool good, bool delivers) {
        const auto n = line.node;
        report.ended(n, since(line.start), io.bytes(held[n]), good);
        if (!good) fatal = true;
        else if (delivers) keep(n, 0, held[n], line.said);
        const auto share = line.span.end();
        add_cost_once(line, share, good);
        if (good) progress.done(step, share, std::nullopt);
    }

    /// Adds what a body that is called once took. One that was stopped counts by the share of its work that it had done.
    void add_cost_once(Line& line, double seconds, bool good) {
        constexpr double least = 0.05;
        const double done = good ? 1 : line.fraction.load();
        if (!good && (!cancelled() || done < least)) return;
        CostSetting at{options.abreast(std::nullopt), line.span.cores(), 0, gathered[line.node], 0, 0};
        if (const auto& growth = line.of().type->growth) {
            if (good && !held[line.node].empty()) line.found = growth->extent(held[line.node][0]);
            const auto all = good ? line.found.count : line.wanted();
            at.items = all > line.before.count ? all - line.before.count : 0;
            at.of = line.found.of;
        }
        costs.add(line.node, Work::once, seconds / done, at);
    }

    /// Adds what a call for one frame took, if it was good. @return its share of the run's wall time
    double add_cost(WorkTimes::Span& span, std::size_t n, Work work, bool good = true) {
        const auto share = span.end();
        const auto& calls = all_calls[n];
        const double abreast = options.abreast(work == Work::frame ? calls.runs : work == Work::take ? calls.takes : calls.loads);
        if (good) costs.add(n, work, share, {abreast, abreast, 0, 0, 0, 0});
        return share;
    }

    /// Whether a frame can't be run: a node before failed there, or the run was cancelled.
    bool hopeless(std::size_t n, const FrameRun& frame, const Wiring& wiring) const { return wiring.failed_before(n, frame) || cancelled(); }

    /// Frame number at a place; nothing for a node that runs once.
    std::optional<int> frame_at(std::size_t n, std::size_t place) const {
        return pipeline.nodes[n].rate == Rate::frame ? std::optional(frames[place]) : std::nullopt;
    }

    /// Caches the outputs and messages of a body, if the node is cached.
    void keep(std::size_t n, std::size_t place, const std::vector<Payload>& outputs, const Said& said) {
        const bool stores = options.cache && (pipeline.nodes[n].kept || !said.empty());
        const RunProfile::Span span(stores ? profile : nullptr, "keep", n, frame_at(n, place));
        store.keep(n, place, outputs, said);
    }

    /// Loads a node's cached outputs into `into`. @return false if they are missing
    bool load(std::size_t n, std::size_t place, std::vector<Payload>& into) {
        const RunProfile::Span span(profile, "load", n, frame_at(n, place));
        WorkTimes::Span cost(costs);
        if (auto outputs = store.result(n, place)) return into = std::move(*outputs), add_cost(cost, n, Work::load), true;
        lost = true;
        return false;
    }

    void load_once(std::size_t n) {
        if (load(n, 0, held[n])) report.holds(n, io.bytes(held[n]));
    }

    /// Calls `finish` of a gatherer. If its result grows, it continues from the cached part of a former run.
    void end_gathering(std::size_t n, void* ports, Context& where, Line& line) {
        if (pipeline.nodes[n].type->growth && pipeline.nodes[n].kept && pipeline.nodes[n].rate != Rate::frame) {
            line.grows = true;
            const auto part = [&] {
                const RunProfile::Span span(profile, "load", n, std::nullopt);
                return store.part(n);
            }();
            if (part) {
                line.grew(line.before = line.of().type->growth->extent(part->first));
                behaviours[n].resume(part->first, part->second);
            }
        }
        behaviours[n].finish(ports, where);
    }

    void finish(std::size_t n) {
        Line line(*this, n);
        const bool delivers = pipeline.nodes[n].rate != Rate::frame;
        const bool good = call(line, nullptr, "finish", [&](void* ports, Context& where) {
            end_gathering(n, ports, where, line);
            if (delivers) held[n] = io.collect(n, ports);
        });
        end_once(line, *steps[n].finish, good, delivers);
    }

    /// Whether the cache takes an output, or one of `by` that works.
    bool wanted(std::size_t n, std::string_view output, const auto& by, const auto& works) const {
        if (pipeline.nodes[n].kept && options.cache) return true;
        return std::any_of(by.begin(), by.end(), [&](std::size_t reader) { return works(reader) && io.reads(reader, n, output); });
    }

    /// @param target  whether the run is for this node's outputs
    void once(std::size_t n, bool target) {
        const auto& node = pipeline.nodes[n];
        const auto& behaviour = behaviours[n];
        const bool connected = std::any_of(node.inputs.begin(), node.inputs.end(), [](const auto& links) { return !links.empty(); });
        Line line(*this, n);
        const bool good = call(line, nullptr, "run", [&](void* ports, Context& where) {
            where.wanting([&](std::string_view output) { return target || wanted(n, output, readers[n], [](std::size_t) { return true; }); });
            if (behaviour.add && connected) behaviour.add(ports, where);
            if (behaviour.digest && connected) behaviour.take(behaviour.digest(ports, where), where);
            if (behaviour.finish) end_gathering(n, ports, where, line);
            if (behaviour.run) behaviour.run(ports, where);
            held[n] = io.collect(n, ports);
        });
        end_once(line, *steps[n].run, good, true);
    }

    /// Runs or loads a per-frame node in one frame.
    void run(std::size_t n, FrameRun& frame, const Wiring& wiring, bool target) {
        const auto action = frame.scheduled.results[n];
        if (action == Action::load) {
            frame.failed[n] = cancelled() || !load(n, frame.place, frame.outputs[n]);
        } else if (action == Action::run && hopeless(n, frame, wiring)) {
            frame.failed[n] = true;
        } else if (action == Action::run) {
            const auto works = [&](std::size_t reader) { return frame.scheduled.reads(reader); };
            Line line(*this, n);
            frame.failed[n] = !call(line, &frame, "run", [&](void* ports, Context& where) {
                where.wanting([&](std::string_view output) { return target || wanted(n, output, wiring.readers[n], works); });
                behaviours[n].run(ports, where);
                frame.outputs[n] = io.collect(n, ports);
            });
            report.ran(n, frame.place, since(line.start), io.bytes(frame.outputs[n]));
            if (!frame.failed[n]) keep(n, frame.place, frame.outputs[n], line.said);
            progress.done(*steps[n].run, add_cost(line.span, n, Work::frame, !frame.failed[n]), frames[frame.place]);
        }
        wiring.release(n, frame);
    }

    /// Computes or loads a gatherer's digest of a frame, concurrently with other frames. It becomes the gatherer's only output in
    /// the frame.
    void digest(std::size_t n, FrameRun& frame, const Wiring& wiring) {
        if (!behaviours[n].digest) return;
        const auto how = frame.scheduled.takes[n];
        if (how == Take::kept) {
            const RunProfile::Span span(profile, "load", n, frames[frame.place]);
            WorkTimes::Span cost(costs);
            if (auto kept = store.digest(n, frame.place)) frame.outputs[n] = {std::move(*kept)};
            else lost = true;
            add_cost(cost, n, Work::load);
            frame.failed[n] = frame.outputs[n].empty();
        } else if (how == Take::anew && hopeless(n, frame, wiring)) {
            frame.failed[n] = true;
        } else if (how == Take::anew) {
            Line line(*this, n);
            frame.failed[n] = !call(line, &frame, "digest", [&](void* ports, Context& where) { frame.outputs[n] = {behaviours[n].digest(ports, where)}; });
            report.took(n, frame.place, since(line.start), io.bytes(frame.outputs[n]));
            if (!frame.failed[n]) {
                const bool stores = options.cache && pipeline.nodes[n].digests_kept;
                const RunProfile::Span span(stores ? profile : nullptr, "keep", n, frames[frame.place]);
                store.keep_digest(n, frame.place, frame.outputs[n].front(), line.said);
            }
            progress.done(*steps[n].add, add_cost(line.span, n, Work::take, !frame.failed[n]), frames[frame.place]);
        }
    }

    bool take(Line& line, const FrameRun& frame) {
        const auto& behaviour = behaviours[line.node];
        if (!behaviour.digest) return call(line, &frame, "take", [&](void* ports, Context& where) { behaviour.add(ports, where); });
        return guarded(line.node, frames[frame.place], "take", [&] {
            auto where = context(line, &frame);
            behaviour.take(frame.outputs[line.node].at(0), where);
        });
    }

    /// Hands one frame to a gatherer. @param all  whether the gatherer will finish @return false if the frame failed
    bool add(std::size_t n, FrameRun& frame, const Wiring& wiring, bool all) {
        bool good = true;
        if (const auto how = frame.scheduled.takes[n]; how != Take::none) {
            good = !cancelled() && !frame.failed[n] && (how == Take::kept || !wiring.failed_before(n, frame));
            Line line(*this, n);
            if (good && all) good = take(line, frame);
            if (!behaviours[n].digest) {
                report.took(n, frame.place, since(line.start), 0);
                progress.done(*steps[n].add, add_cost(line.span, n, Work::take, good && all), frames[frame.place]);
            }
            if (good && all) {
                report.gathered(n, frame.place);
                ++gathered[n];
            }
        }
        wiring.release(n, frame);
        return good;
    }

    void run_once(const std::vector<std::size_t>& nodes, const Plan& plan, const Schedule& schedule) {
        for (const auto n : nodes) {
            if (stopped()) return;
            if (schedule.once[n] == Action::run) once(n, plan.targets[n]);
            if (schedule.once[n] == Action::load) load_once(n);
            for (const auto source : io.sources(n))
                if (readers[source].erase(n) == 1 && readers[source].empty()) held[source].clear();
        }
    }

    void announce(const Schedule& schedule);
    void run_pass(std::size_t p, const Plan& plan, const Schedule& schedule);
};

Flow::Flow(const Pipeline& pipeline, const Registry& registry, const Timelines& timelines, const RunOptions& options, Store& store, InputGuard& guard,
           Report& report, Progress& progress, WorkTimes& costs, RunProfile* profile, std::function<bool()> cancelled)
    : self_(new Self{pipeline, registry, timelines, options, store, guard, report, progress, costs, profile, std::move(cancelled)}) {
    for (const auto& node : pipeline.nodes) self_->behaviours.push_back(node.type->bind(node.params));
}

Flow::~Flow() = default;

bool Flow::stopped() const { return self_->stopped(); }
bool Flow::lost() const { return self_->lost; }

/// Registers everything that will run with the progress display.
void Flow::Self::announce(const Schedule& schedule) {
    all_calls = calls_of(schedule);
    progress.begin_again();
    const auto step = [&](std::size_t n, std::size_t runs, Work work) {
        return runs > 0 ? std::optional(progress.add({pipeline.nodes[n].name, runs, costs.expected(n, work)})) : std::nullopt;
    };
    for (std::size_t n = 0; n < all_calls.size(); ++n) {
        const auto& calls = all_calls[n];
        const bool finishes = schedule.gathers[n] != 0;
        steps[n].add = step(n, calls.takes, Work::take);
        steps[n].finish = step(n, finishes ? 1 : 0, Work::once);
        steps[n].run = calls.runs > 0 ? step(n, calls.runs, Work::frame) : step(n, calls.once && !finishes ? 1 : 0, Work::once);
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
    ReadAhead ahead(std::move(read), std::move(written), static_cast<std::size_t>(self.options.in_flight), self.options.memory);
    flow::graph graph;
    std::size_t next = 0;
    // Only numbers wait in front of the limiter. Frames are created behind it.
    flow::input_node<std::size_t> source(graph, [&](tbb::flow_control& control) -> std::size_t {
        if (next == places.size() || self.stopped()) return control.stop(), 0;
        return next++;
    });
    flow::limiter_node<std::size_t> limiter(graph, static_cast<std::size_t>(std::max(1, self.options.in_flight)));
    int ends = 0;
    for (const auto unit : wiring.units) ends += wiring.readers[unit].empty() ? 1 : 0;
    flow::function_node<std::size_t, Token> admit(graph, flow::unlimited, [&](std::size_t order) {
        ++self.in_flight;
        ahead.begin(order);
        auto frame = std::make_shared<FrameRun>(places[order], order, frames_of_pass[places[order]]);
        frame->open = ends;
        for (const auto unit : wiring.units) {
            frame->waiting[unit] = static_cast<int>(std::max<std::size_t>(1, wiring.sources[unit].size()));
            frame->readers[unit] = static_cast<int>(wiring.readers[unit].size());
        }
        return frame;
    });
    flow::function_node<Token, flow::continue_msg> retire(graph, flow::unlimited, [&](const Token& frame) {
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
        const bool gathers_here = std::find(pass.gatherers.begin(), pass.gatherers.end(), n) != pass.gatherers.end();
        units[n] = std::make_unique<Unit>(graph, flow::unlimited, [&self, &wiring, &plan, n, gathers_here](const Token& frame, Unit::output_ports_type& out) {
            if (frame->waiting[n].fetch_sub(1) != 1) return;
            if (gathers_here) self.digest(n, *frame, wiring);
            else self.run(n, *frame, wiring, plan.targets[n]);
            std::get<0>(out).try_put(frame);
        });
        if (!gathers_here) continue;
        auto& gather = gathers[n];
        // Every admitted frame must pass, also a failed one: a gap would block the sequencer forever.
        gather.order = std::make_unique<flow::sequencer_node<Token>>(graph, [](const Token& frame) { return frame->order; });
        gather.add = std::make_unique<flow::function_node<Token, Token>>(graph, flow::serial, [&self, &wiring, &gather, &schedule, n](const Token& frame) {
            if (!self.add(n, *frame, wiring, schedule.gathers[n] != 0)) gather.lost.push_back(self.frames[frame->place]);
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
                            fmt::format("needs every frame of the sequence, but these failed: {}", FrameSet(gathers[n].lost).text()), Failure::Kind::data});
        self.failed = self.fatal = true;
    }
}

}  // namespace fluidcarve
