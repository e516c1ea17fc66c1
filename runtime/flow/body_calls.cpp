#include "runtime/flow/body_calls.h"

#include "runtime/flow/out_of_memory.h"

#include <tbb/task_arena.h>

#include <array>
#include <new>

namespace fluidcarve {

namespace {

/// Names of phases in the profile (RunProfile::Span).
constexpr std::array categories{"run", "digest", "consume", "finish"};

/// Whether a node makes its outputs of a frame, and does not consume the frame.
bool delivers(std::size_t n, const FrameRun* frame) {
    return frame && frame->scheduled.results[n] == Schedule::Action::run;
}

}  // namespace

BodyCalls::BodyCalls(const FlowSetup& setup, const PortIo::Outputs& held)
    : setup_(setup),
      io_{setup.pipeline, setup.registry},
      held_(held),
      provenance_(setup.pipeline, setup.registry, held) {
    for (const auto& node : setup.pipeline.nodes)
        behaviours_.push_back(node.type->bind(node.params));
}

bool BodyCalls::stopped() const {
    return setup_.cancelled() || fatal_ || (failed_ && !setup_.options.keep_going);
}

std::optional<int> BodyCalls::number(const FrameRun* frame) const {
    return frame ? std::optional(setup_.timelines.frames()[frame->t]) : std::nullopt;
}

Context BodyCalls::context(BodyHost& host, const FrameRun* frame) const {
    const auto& timelines = setup_.timelines;
    const auto& [numbers, index] = delivers(host.node, frame) ? timelines.delivered(host.node)
                                                              : timelines.input_frames(host.node);
    auto out = Context(host, numbers).limits({setup_.options.memory, setup_.options.work_folder});
    return frame ? out.at(index.at(frame->t).value()) : out;
}

bool BodyCalls::guarded(std::size_t n, std::optional<int> frame, Phase phase,
                        const std::function<void()>& body) {
    const auto event = setup_.events.event(categories[static_cast<std::size_t>(phase)], n, frame);
    try {
        // Isolate the body: a thread that waits in a parallel loop of the body must not start the
        // body of another frame.
        tbb::this_task_arena::isolate(body);
        return true;
    } catch (const Cancelled&) {
    } catch (const Failure& failure) {
        fail(n, frame, failure.what(), failure.kind);
    } catch (const std::bad_alloc&) {
        fail(n, frame, out_of_memory(phase, in_flight, memory_now()), Failure::Kind::data);
    } catch (const std::exception& error) {
        fail(n, frame, error.what(), Failure::Kind::data);
    }
    return false;
}

void BodyCalls::fail(std::size_t n, std::optional<int> frame, const std::string& message,
                     Failure::Kind kind) {
    setup_.events.failed(failure_in(setup_.pipeline.nodes[n], frame, message, kind));
    failed_ = true;
}

bool BodyCalls::call(BodyHost& host, const FrameRun* frame, Phase phase, const Body& body) {
    const auto n = host.node;
    return guarded(n, number(frame), phase, [&] {
        const auto ports = behaviours_[n].make_ports();
        // A node that retimes has consumed the frames of its inputs before.
        const bool inputs = frame && !(delivers(n, frame) && setup_.pipeline.nodes[n].retimes());
        io_.connect(n, ports.get(), held_, inputs ? &frame->outputs : nullptr);
        auto where = context(host, frame);
        setup_.guard.read(setup_.store.inputs(n, frame ? frame->t : 0),
                          [&] { body(ports.get(), where); });
    });
}

bool BodyCalls::call_without_ports(BodyHost& host, const FrameRun& frame, Phase phase,
                                   const std::function<void(Context&)>& body) {
    return guarded(host.node, number(&frame), phase, [&] {
        auto where = context(host, &frame);
        body(where);
    });
}

}  // namespace fluidcarve
