#pragma once

#include "runtime/plan/frame_run.h"
#include "runtime/run/file_provenance.h"
#include "runtime/run/flow.h"
#include "runtime/run/out_of_memory.h"
#include "runtime/run/ports.h"
#include "runtime/run/read_ahead.h"

#include <tbb/flow_graph.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <mutex>
#include <new>
#include <set>

namespace fluidcarve {

struct Flow::Self {
    using Clock = std::chrono::steady_clock;
    using Token = std::shared_ptr<FrameRun>;
    using Action = Schedule::Action;
    using Take = Schedule::Take;

    static double since(Clock::time_point start) {
        return std::chrono::duration<double>(Clock::now() - start).count();
    }

    /// The Context::Host of one call of a body. Forwards messages to the run, and records them for
    /// the cache.
    struct Line : Context::Host {
        Line(Self& run, std::size_t node) : run(run), node(node), span(run.costs) {}
        Self& run;
        const std::size_t node;
        const Clock::time_point start = Clock::now();
        WorkTimes::Span span;
        std::atomic<double> fraction{0};  ///< of the work of `finish`
        Extent found{},
            before{};  ///< of a growing result: its kept extent, and its extent in an earlier run
        std::mutex mutex;
        Said said;
        bool grows = false;  ///< `hold` caches the present part of a growing result
        Clock::time_point next_hold{};

        bool cancelled() const override { return run.cancelled(); }
        void warn(const std::string& message) override {
            run.report.warn(node, message);
            const std::lock_guard lock(mutex);
            said.warnings.push_back(message);
        }
        void warn_at_once(const std::string& message) override {
            if (const auto line = run.report.warn(node, message); !line.empty())
                run.progress.say(line);
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
            if (run.steps[node].finish)
                run.progress.part(*run.steps[node].finish, share, since(start));
        }
        void hold(const Payload& result) override {
            const std::lock_guard lock(mutex);
            const auto begin = Clock::now();
            if (!grows || begin < next_hold) return;
            const RunProfile::Span span(run.profile, "keep", node, std::nullopt);
            run.store.keep_grown(node, 0, result, said, true);
            grew(of().type->growth->extent(result));
            // Wait ten times as long as the write took, so that writing takes at most a tenth of
            // the time.
            constexpr int pauses = 10;
            next_hold = Clock::now() + pauses * (Clock::now() - begin);
        }
        void grew(const Extent& extent) {
            found = extent;
            run.report.grew(node, extent.count, wanted());
        }
        std::size_t wanted() const {
            return of().type->growth->wanted(of().params.get(), found.of);
        }
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
    std::vector<Calls> all_calls{};  ///< per node
    /// Per node: frames that it has taken.
    std::vector<std::size_t> gathered = std::vector<std::size_t>(pipeline.nodes.size());
    std::vector<std::vector<Payload>> held = std::vector<std::vector<Payload>>(
        pipeline.nodes.size());  ///< `[node][output]`: outputs of nodes that run once
    /// Per node: nodes that may still read its held outputs.
    std::vector<std::set<std::size_t>> readers = io.readers();
    std::atomic<bool> failed{false};        ///< a body failed
    std::atomic<bool> fatal{false};         ///< the failure ends the run even with `keep_going`
    std::atomic<bool> lost{false};          ///< a cached result is missing
    std::atomic<std::size_t> in_flight{0};  ///< frames
    FileProvenance provenance{pipeline, registry, held};

    bool stopped() const { return cancelled() || fatal || lost || (failed && !options.keep_going); }

    /// Whether a node makes its outputs of a frame, instead of taking the frame.
    static bool delivers(std::size_t n, const FrameRun* frame) {
        return frame && frame->scheduled.results[n] == Action::run;
    }

    Context context(Line& line, const FrameRun* frame) {
        const auto& [numbers, index] = delivers(line.node, frame) ? timelines.delivered(line.node)
                                                                  : timelines.taken(line.node);
        auto out = Context(line, numbers).limits(options.memory, options.work_folder);
        return frame ? out.at(index.at(frame->place).value()) : out;
    }

    /// Calls a body and turns exceptions into Faults. An exception that escaped would cancel the
    /// whole flow graph.
    /// @param what  category in the profile
    /// @return false if the body threw
    bool guarded(std::size_t n, std::optional<int> frame, const char* what,
                 const std::function<void()>& body) {
        const RunProfile::Span span(profile, what, n, frame);
        const auto fault = [&](const std::string& message, Failure::Kind kind) {
            report.failed(
                {pipeline.nodes[n].name, pipeline.nodes[n].type->name, frame, message, kind});
            failed = true;
            return false;
        };
        try {
            // Isolate the body: a thread that waits in a parallel loop of the body must not start
            // the body of another frame.
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
    bool call(Line& line, const FrameRun* frame, const char* what,
              const std::function<void(void* ports, Context&)>& body) {
        return guarded(
            line.node, frame ? std::optional(frames[frame->place]) : std::nullopt, what, [&] {
                const auto ports = behaviours[line.node].make_ports();
                const bool inputs =
                    frame && !(delivers(line.node, frame) &&
                               line.of().retimes());  // it has taken their frames before
                io.connect(line.node, ports.get(), held, inputs ? &frame->outputs : nullptr);
                auto where = context(line, frame);
                guard.read(store.inputs(line.node, frame ? frame->place : 0),
                           [&] { body(ports.get(), where); });
            });
    }

    /// Reports the end of a body that is called once, and caches its outputs. A failure there ends
    /// the run.
    void end_once(Line& line, std::size_t step, bool good, bool delivers) {
        const auto n = line.node;
        report.ended(n, since(line.start), io.bytes(held[n]), good);
        if (!good) fatal = true;
        else if (delivers) keep(n, 0, held[n], line.said);
        const auto share = line.span.end();
        add_cost_once(line, share, good);
        if (good) progress.done(step, share, std::nullopt);
    }

    /// Adds the cost of a body that is called once. A stopped body counts by the share of its work
    /// that it had done.
    void add_cost_once(Line& line, double seconds, bool good) {
        constexpr double least = 0.05;
        const double done = good ? 1 : line.fraction.load();
        if (!good && (!cancelled() || done < least)) return;
        CostSetting at{
            options.abreast(std::nullopt), line.span.cores(), 0, gathered[line.node], 0, 0};
        if (const auto& growth = line.of().type->growth) {
            if (good && !held[line.node].empty()) line.found = growth->extent(held[line.node][0]);
            const auto all = good ? line.found.count : line.wanted();
            at.items = all > line.before.count ? all - line.before.count : 0;
            at.of = line.found.of;
        }
        costs.add(line.node, Work::once, seconds / done, at);
    }

    /// Adds the cost of a call for one frame, if it succeeded.
    /// @return its share of the run's wall time
    double add_cost(WorkTimes::Span& span, std::size_t n, Work work, bool good = true) {
        const auto share = span.end();
        const auto& calls = all_calls[n];
        const double abreast = options.abreast(work == Work::frame  ? calls.runs
                                               : work == Work::take ? calls.takes
                                                                    : calls.loads);
        if (good) costs.add(n, work, share, {abreast, abreast, 0, 0, 0, 0});
        return share;
    }

    /// Whether a frame can't be run: a node upstream failed there, or the run was cancelled.
    bool hopeless(std::size_t n, const FrameRun& frame, const Wiring& wiring) const {
        return wiring.failed_before(n, frame) || cancelled();
    }

    /// Frame number at a place; nothing for a node that runs once.
    std::optional<int> frame_at(std::size_t n, std::size_t place) const {
        return pipeline.nodes[n].rate == Rate::frame ? std::optional(frames[place]) : std::nullopt;
    }

    /// Caches the outputs and messages of a body, if the node is cached.
    void keep(std::size_t n, std::size_t place, const std::vector<Payload>& outputs,
              const Said& said) {
        const bool stores = options.cache && (pipeline.nodes[n].kept || !said.empty());
        const RunProfile::Span span(stores ? profile : nullptr, "keep", n, frame_at(n, place));
        store.keep(n, place, outputs, said);
    }

    /// Loads a node's cached outputs into `into`. @return false if they are missing
    bool load(std::size_t n, std::size_t place, std::vector<Payload>& into) {
        const RunProfile::Span span(profile, "load", n, frame_at(n, place));
        WorkTimes::Span cost(costs);
        if (auto outputs = store.result(n, place))
            return into = std::move(*outputs), add_cost(cost, n, Work::load), true;
        lost = true;
        return false;
    }

    void load_once(std::size_t n) {
        if (load(n, 0, held[n])) report.holds(n, io.bytes(held[n]));
    }

    /// Calls `finish` of a gatherer. If its result grows, it continues from the cached part of a
    /// former run.
    void end_gathering(std::size_t n, void* ports, Context& where, Line& line) {
        if (pipeline.nodes[n].type->growth && pipeline.nodes[n].kept &&
            pipeline.nodes[n].rate != Rate::frame) {
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
            if (!delivers) return;
            if (behaviours[n].run) behaviours[n].run(ports, where);
            held[n] = io.collect(n, ports);
        });
        end_once(line, *steps[n].finish, good, delivers);
    }

    /// Whether an output is needed: by the cache, or by a node of `by` that works.
    bool wanted(std::size_t n, std::string_view output, const auto& by, const auto& works) const {
        if (pipeline.nodes[n].kept && options.cache) return true;
        return std::any_of(by.begin(), by.end(), [&](std::size_t reader) {
            return works(reader) && io.reads(reader, n, output);
        });
    }

    /// @param target  whether this node's outputs are a target of the run
    void once(std::size_t n, bool target) {
        const auto& node = pipeline.nodes[n];
        const auto& behaviour = behaviours[n];
        const bool connected = std::any_of(node.inputs.begin(), node.inputs.end(),
                                           [](const auto& links) { return !links.empty(); });
        Line line(*this, n);
        const bool good = call(line, nullptr, "run", [&](void* ports, Context& where) {
            where.wanting([&](std::string_view output) {
                return target || wanted(n, output, readers[n], [](std::size_t) { return true; });
            });
            if (behaviour.add && connected) behaviour.add(ports, where);
            if (behaviour.digest && connected)
                behaviour.take(behaviour.digest(ports, where), where);
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
                where.wanting([&](std::string_view output) {
                    return target || wanted(n, output, wiring.readers[n], works);
                });
                behaviours[n].run(ports, where);
                frame.outputs[n] = io.collect(n, ports);
            });
            report.ran(n, frame.place, since(line.start), io.bytes(frame.outputs[n]));
            if (!frame.failed[n]) keep(n, frame.place, frame.outputs[n], line.said);
            progress.done(*steps[n].run, add_cost(line.span, n, Work::frame, !frame.failed[n]),
                          frames[frame.place]);
        }
        wiring.release(n, frame);
    }

    /// Computes or loads a gatherer's digest of a frame, concurrently with other frames. It becomes
    /// the gatherer's only output in the frame.
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
            frame.failed[n] = !call(line, &frame, "digest", [&](void* ports, Context& where) {
                frame.outputs[n] = {behaviours[n].digest(ports, where)};
            });
            report.took(n, frame.place, since(line.start), io.bytes(frame.outputs[n]));
            if (!frame.failed[n]) {
                const bool stores = options.cache && pipeline.nodes[n].digests_kept;
                const RunProfile::Span span(stores ? profile : nullptr, "keep", n,
                                            frames[frame.place]);
                store.keep_digest(n, frame.place, frame.outputs[n].front(), line.said);
            }
            progress.done(*steps[n].add, add_cost(line.span, n, Work::take, !frame.failed[n]),
                          frames[frame.place]);
        }
    }

    bool take(Line& line, const FrameRun& frame) {
        const auto& behaviour = behaviours[line.node];
        if (!behaviour.digest)
            return call(line, &frame, "take",
                        [&](void* ports, Context& where) { behaviour.add(ports, where); });
        return guarded(line.node, frames[frame.place], "take", [&] {
            auto where = context(line, &frame);
            behaviour.take(frame.outputs[line.node].at(0), where);
        });
    }

    /// Hands one frame to a gatherer.
    /// @param all  whether the gatherer will finish
    /// @return false if the frame failed
    bool add(std::size_t n, FrameRun& frame, const Wiring& wiring, bool all) {
        bool good = true;
        if (const auto how = frame.scheduled.takes[n]; how != Take::none) {
            good = !cancelled() && !frame.failed[n] &&
                   (how == Take::kept || !wiring.failed_before(n, frame));
            Line line(*this, n);
            if (good && all) good = take(line, frame);
            if (!behaviours[n].digest) {
                report.took(n, frame.place, since(line.start), 0);
                progress.done(*steps[n].add, add_cost(line.span, n, Work::take, good && all),
                              frames[frame.place]);
            }
            if (good && all) {
                report.gathered(n, frame.place);
                ++gathered[n];
            }
        }
        wiring.release(n, frame);
        return good;
    }

    void run_once(const std::vector<std::size_t>& nodes, const Plan& plan,
                  const Schedule& schedule) {
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

}  // namespace fluidcarve
