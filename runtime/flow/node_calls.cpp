#include "runtime/flow/node_calls.h"

#include "carve/base/frame_set.h"
#include "runtime/flow/out_of_memory.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <new>

namespace fluidcarve {

namespace {

/// Whether a node makes its outputs of a frame, and does not consume the frame.
bool delivers(std::size_t n, const FrameRun* frame) {
    return frame && frame->scheduled.results[n] == Schedule::Action::run;
}

}  // namespace

NodeCalls::NodeCalls(const FlowSetup& setup)
    : setup_(setup),
      io_{setup.pipeline, setup.registry},
      gathered_(setup.pipeline.nodes.size()),
      held_(setup.pipeline.nodes.size()),
      readers_(io_.readers()),
      provenance_(setup.pipeline, setup.registry, held_) {
    for (const auto& node : setup.pipeline.nodes)
        behaviours_.push_back(node.type->bind(node.params));
}

bool NodeCalls::stopped() const {
    return setup_.cancelled() || fatal_ || lost_ || (failed_ && !setup_.options.keep_going);
}

std::optional<int> NodeCalls::frame_at(std::size_t n, std::size_t t) const {
    return node(n).rate == Rate::frame ? std::optional(frame_number(t)) : std::nullopt;
}

Context NodeCalls::context(BodyHost& host, const FrameRun* frame) const {
    const auto& timelines = setup_.timelines;
    const auto& [numbers, index] = delivers(host.node, frame) ? timelines.delivered(host.node)
                                                              : timelines.input_frames(host.node);
    auto out = Context(host, numbers).limits({setup_.options.memory, setup_.options.work_folder});
    return frame ? out.at(index.at(frame->t).value()) : out;
}

bool NodeCalls::guarded(std::size_t n, std::optional<int> frame, const char* what,
                        const std::function<void()>& body) {
    const auto event = setup_.events.event(what, n, frame);
    try {
        // Isolate the body: a thread that waits in a parallel loop of the body must not start the
        // body of another frame.
        tbb::this_task_arena::isolate(body);
        return true;
    } catch (const Cancelled&) {
    } catch (const Failure& failure) {
        fail(n, frame, failure.what(), failure.kind);
    } catch (const std::bad_alloc&) {
        fail(n, frame, out_of_memory(what, in_flight, memory_now()), Failure::Kind::data);
    } catch (const std::exception& error) {
        fail(n, frame, error.what(), Failure::Kind::data);
    }
    return false;
}

void NodeCalls::fail(std::size_t n, std::optional<int> frame, const std::string& message,
                     Failure::Kind kind) {
    setup_.events.failed(failure_in(node(n), frame, message, kind));
    failed_ = true;
}

void NodeCalls::lacks_frames(std::size_t n, const std::vector<int>& failed) {
    fail(n, std::nullopt,
         fmt::format("needs every frame of the sequence, but these failed: {}",
                     FrameSet(failed).text()),
         Failure::Kind::data);
    fatal_ = true;
}

bool NodeCalls::call(BodyHost& host, const FrameRun* frame, const char* what, const Body& body) {
    const auto n = host.node;
    const auto number = frame ? std::optional(frame_number(frame->t)) : std::nullopt;
    return guarded(n, number, what, [&] {
        const auto ports = behaviours_[n].make_ports();
        // A node that retimes has consumed the frames of its inputs before.
        const bool inputs = frame && !(delivers(n, frame) && node(n).retimes());
        io_.connect(n, ports.get(), held_, inputs ? &frame->outputs : nullptr);
        auto where = context(host, frame);
        setup_.guard.read(setup_.store.inputs(n, frame ? frame->t : 0),
                          [&] { body(ports.get(), where); });
    });
}

bool NodeCalls::hopeless(std::size_t n, const FrameRun& frame, const Wiring& wiring) const {
    return wiring.failed_before(n, frame) || setup_.cancelled();
}

bool NodeCalls::wanted(std::size_t n, std::string_view output, const auto& by,
                       const auto& works) const {
    if (node(n).kept && setup_.options.cache) return true;
    return std::ranges::any_of(
        by, [&](std::size_t reader) { return works(reader) && io_.reads(reader, n, output); });
}

// What is cached.

void NodeCalls::keep(const BodyHost& host, std::size_t t, const std::vector<Payload>& outputs) {
    const auto n = host.node;
    const bool stores = setup_.options.cache && (node(n).kept || !host.log.empty());
    const auto event = setup_.events.event("keep", n, frame_at(n, t), stores);
    setup_.store.keep(n, t, outputs, host.log);
}

void NodeCalls::keep_digest(const BodyHost& host, std::size_t t, const Payload& digest) {
    const auto n = host.node;
    const bool stores = setup_.options.cache && node(n).digests_kept;
    const auto event = setup_.events.event("keep", n, frame_number(t), stores);
    setup_.store.keep_digest(n, t, digest, host.log);
}

bool NodeCalls::load(std::size_t n, std::size_t t, std::vector<Payload>& into) {
    const auto event = setup_.events.event("load", n, frame_at(n, t));
    auto work = setup_.events.work();
    auto outputs = setup_.store.result(n, t);
    if (!outputs) lost_ = true;
    if (!outputs) return false;
    into = std::move(*outputs);
    setup_.events.loaded(n, work);
    return true;
}

void NodeCalls::load_once(std::size_t n) {
    if (load(n, 0, held_[n])) setup_.events.holds(n, io_.bytes(held_[n]));
}

// Calls for one frame.

void NodeCalls::call_for_frame(Work work, std::size_t n, FrameRun& frame, const Body& body) {
    BodyHost host(setup_, provenance_, n);
    const bool good = call(host, &frame, work == Work::consume ? "digest" : "run", body);
    frame.failed[n] = !good;
    setup_.events.body_ended(work, n, frame.t, host.seconds(), io_.bytes(frame.outputs[n]));
    if (good && work == Work::consume) keep_digest(host, frame.t, frame.outputs[n].front());
    if (good && work == Work::frame) keep(host, frame.t, frame.outputs[n]);
    setup_.events.call_ended(work, n, host.span, frame_number(frame.t), good);
}

void NodeCalls::run(std::size_t n, FrameRun& frame, const Wiring& wiring, bool target) {
    const auto action = frame.scheduled.results[n];
    if (action == Action::load) {
        frame.failed[n] = setup_.cancelled() || !load(n, frame.t, frame.outputs[n]);
    } else if (action == Action::run && hopeless(n, frame, wiring)) {
        frame.failed[n] = true;
    } else if (action == Action::run) {
        const auto works = [&](std::size_t reader) { return frame.scheduled.reads(reader); };
        call_for_frame(Work::frame, n, frame, [&](void* ports, Context& context) {
            context.wanting([&](std::string_view output) {
                return target || wanted(n, output, wiring.readers[n], works);
            });
            behaviours_[n].run(ports, context);
            frame.outputs[n] = io_.collect(n, ports);
        });
    }
    wiring.release(n, frame);
}

void NodeCalls::digest(std::size_t n, FrameRun& frame, const Wiring& wiring) {
    if (!behaviours_[n].digest) return;
    const auto how = frame.scheduled.consumes[n];
    if (how == Consume::digest) {
        const auto event = setup_.events.event("load", n, frame_number(frame.t));
        auto work = setup_.events.work();
        if (auto kept = setup_.store.digest(n, frame.t)) frame.outputs[n] = {std::move(*kept)};
        else lost_ = true;
        setup_.events.loaded(n, work);
        frame.failed[n] = frame.outputs[n].empty();
    } else if (how == Consume::inputs && hopeless(n, frame, wiring)) {
        frame.failed[n] = true;
    } else if (how == Consume::inputs) {
        call_for_frame(Work::consume, n, frame, [&](void* ports, Context& context) {
            frame.outputs[n] = {behaviours_[n].digest(ports, context)};
        });
    }
}

bool NodeCalls::consume_now(BodyHost& host, const FrameRun& frame) {
    const auto& behaviour = behaviours_[host.node];
    if (!behaviour.digest) return call(host, &frame, "consume", behaviour.add);
    return guarded(host.node, frame_number(frame.t), "consume", [&] {
        auto where = context(host, &frame);
        behaviour.consume(frame.outputs[host.node].at(0), where);
    });
}

bool NodeCalls::consume(std::size_t n, FrameRun& frame, const Wiring& wiring, bool finishes) {
    bool good = true;
    if (const auto how = frame.scheduled.consumes[n]; how != Consume::none) {
        good = !setup_.cancelled() && !frame.failed[n] &&
               (how == Consume::digest || !wiring.failed_before(n, frame));
        BodyHost host(setup_, provenance_, n);
        if (good && finishes) good = consume_now(host, frame);
        if (!behaviours_[n].digest) {
            setup_.events.body_ended(Work::consume, n, frame.t, host.seconds(), 0);
            setup_.events.call_ended(Work::consume, n, host.span, frame_number(frame.t),
                                     good && finishes);
        }
        if (good && finishes) {
            setup_.events.gathered(n, frame.t);
            ++gathered_[n];
        }
    }
    wiring.release(n, frame);
    return good;
}

// Calls for all frames.

void NodeCalls::finish_from_cached(BodyHost& host, void* ports, Context& context) {
    const auto n = host.node;
    if (const auto& growth = node(n).type->growth;
        growth && node(n).kept && node(n).rate != Rate::frame) {
        host.grows();
        const auto part = [&] {
            const auto event = setup_.events.event("load", n, std::nullopt);
            return setup_.store.part(n);
        }();
        if (part) {
            host.goes_on_from(growth->item_count(part->first));
            behaviours_[n].resume(part->first, part->second);
        }
    }
    behaviours_[n].finish(ports, context);
}

void NodeCalls::end_once(BodyHost& host, bool good, bool delivers) {
    const auto n = host.node;
    setup_.events.once_body_ended(n, host.seconds(), io_.bytes(held_[n]), good);
    if (!good) fatal_ = true;
    else if (delivers) keep(host, 0, held_[n]);
    CostSetting at;
    at.gathered = gathered_[n];
    const double share = good ? 1 : setup_.cancelled() ? host.share() : 0;
    if (share > 0) host.count_items(good && !held_[n].empty() ? &held_[n][0] : nullptr, at);
    setup_.events.once_call_ended(n, host.span, good, share, at);
}

void NodeCalls::finish(std::size_t n) {
    BodyHost host(setup_, provenance_, n);
    const bool delivers = node(n).rate != Rate::frame;
    const bool good = call(host, nullptr, "finish", [&](void* ports, Context& context) {
        finish_from_cached(host, ports, context);
        if (!delivers) return;
        if (behaviours_[n].run) behaviours_[n].run(ports, context);
        held_[n] = io_.collect(n, ports);
    });
    end_once(host, good, delivers);
}

void NodeCalls::once(std::size_t n, bool target) {
    const auto& behaviour = behaviours_[n];
    const bool connected =
        std::ranges::any_of(node(n).inputs, [](const auto& links) { return !links.empty(); });
    BodyHost host(setup_, provenance_, n);
    const bool good = call(host, nullptr, "run", [&](void* ports, Context& context) {
        context.wanting([&](std::string_view output) {
            return target || wanted(n, output, readers_[n], [](std::size_t) { return true; });
        });
        if (behaviour.add && connected) behaviour.add(ports, context);
        if (behaviour.digest && connected)
            behaviour.consume(behaviour.digest(ports, context), context);
        if (behaviour.finish) finish_from_cached(host, ports, context);
        if (behaviour.run) behaviour.run(ports, context);
        held_[n] = io_.collect(n, ports);
    });
    end_once(host, good, true);
}

void NodeCalls::release(std::size_t n) {
    for (const auto source : io_.sources(n))
        if (readers_[source].erase(n) == 1 && readers_[source].empty()) held_[source].clear();
}

}  // namespace fluidcarve
