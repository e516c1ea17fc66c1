#include "runtime/flow/frame_calls.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace fluidcarve {

FrameCalls::FrameCalls(const FlowSetup& setup, BodyCalls& bodies, CachedResults& results,
                       const Wiring& wiring)
    : setup_(setup),
      bodies_(bodies),
      results_(results),
      wiring_(wiring),
      io_{setup.pipeline, setup.registry},
      consumed_{std::vector<std::size_t>(setup.pipeline.nodes.size()),
                std::vector<std::vector<int>>(setup.pipeline.nodes.size())} {}

bool FrameCalls::hopeless(std::size_t n, const FrameRun& frame) const {
    return wiring_.failed_before(n, frame) || setup_.cancelled();
}

void FrameCalls::call(Work work, std::size_t n, FrameRun& frame, const BodyCalls::Body& body) {
    auto host = bodies_.host(n);
    const bool good =
        bodies_.call(host, &frame, work == Work::consume ? Phase::digest : Phase::run, body);
    frame.failed[n] = !good;
    setup_.events.body_ended(work, n, frame.t, host.seconds(), io_.bytes(frame.outputs[n]));
    if (good && work == Work::consume)
        results_.keep_digest(host, frame.t, frame.outputs[n].front());
    if (good && work == Work::frame) results_.keep(host, frame.t, frame.outputs[n]);
    setup_.events.call_ended(work, n, host.span, number(frame), good);
}

void FrameCalls::run(std::size_t n, FrameRun& frame, bool target) {
    const auto action = frame.scheduled.results[n];
    if (action == Action::load) {
        auto loaded = setup_.cancelled() ? std::nullopt : results_.load(n, frame.t);
        frame.failed[n] = !loaded;
        if (loaded) frame.outputs[n] = std::move(*loaded);
    } else if (action == Action::run) {
        if (hopeless(n, frame)) frame.failed[n] = true;
        else run_body(n, frame, target);
    }
    wiring_.release(n, frame);
}

void FrameCalls::run_body(std::size_t n, FrameRun& frame, bool target) {
    call(Work::frame, n, frame, [&](void* ports, Context& context) {
        context.wanting([&](std::string_view output) {
            return target || results_.keeps(n) ||
                   std::ranges::any_of(wiring_.readers[n], [&](std::size_t reader) {
                       return frame.scheduled.reads(reader) && io_.reads(reader, n, output);
                   });
        });
        bodies_.behaviour(n).run(ports, context);
        frame.outputs[n] = io_.collect(n, ports);
    });
}

void FrameCalls::digest(std::size_t n, FrameRun& frame) {
    const auto& behaviour = bodies_.behaviour(n);
    if (!behaviour.digest) return;
    const auto how = frame.scheduled.consumes[n];
    if (how == Consume::digest) {
        if (auto kept = results_.load_digest(n, frame.t)) frame.outputs[n] = {std::move(*kept)};
        frame.failed[n] = frame.outputs[n].empty();
    } else if (how == Consume::inputs) {
        if (hopeless(n, frame)) frame.failed[n] = true;
        else
            call(Work::consume, n, frame, [&](void* ports, Context& context) {
                frame.outputs[n] = {behaviour.digest(ports, context)};
            });
    }
}

void FrameCalls::consume(std::size_t n, FrameRun& frame, bool finishes) {
    if (frame.scheduled.consumes[n] != Consume::none && !consume_scheduled(n, frame, finishes))
        consumed_.failed[n].push_back(number(frame));
    wiring_.release(n, frame);
}

bool FrameCalls::consume_scheduled(std::size_t n, const FrameRun& frame, bool finishes) {
    bool good =
        !setup_.cancelled() && !frame.failed[n] &&
        (frame.scheduled.consumes[n] == Consume::digest || !wiring_.failed_before(n, frame));
    auto host = bodies_.host(n);
    if (good && finishes) good = call_add(host, frame);
    const bool consumed = good && finishes;
    if (!bodies_.behaviour(n).digest) {
        setup_.events.body_ended(Work::consume, n, frame.t, host.seconds(), 0);
        setup_.events.call_ended(Work::consume, n, host.span, number(frame), consumed);
    }
    if (consumed) {
        setup_.events.gathered(n, frame.t);
        ++consumed_.count[n];
    }
    return good;
}

bool FrameCalls::call_add(BodyHost& host, const FrameRun& frame) {
    const auto& behaviour = bodies_.behaviour(host.node);
    if (!behaviour.digest) return bodies_.call(host, &frame, Phase::consume, behaviour.add);
    return bodies_.call_without_ports(host, frame, Phase::consume, [&](Context& context) {
        behaviour.add_digest(frame.outputs[host.node].at(0), context);
    });
}

}  // namespace fluidcarve
