#include "runtime/flow/once_calls.h"

#include "carve/base/frame_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

namespace fluidcarve {

OnceCalls::OnceCalls(const FlowSetup& setup, BodyCalls& bodies, CachedResults& results,
                     PortIo::Outputs& held)
    : setup_(setup),
      bodies_(bodies),
      results_(results),
      held_(held),
      io_{setup.pipeline, setup.registry},
      readers_(io_.readers()) {}

void OnceCalls::once(std::size_t n, bool target) {
    const auto& behaviour = bodies_.behaviour(n);
    const bool connected =
        std::ranges::any_of(node(n).inputs, [](const auto& links) { return !links.empty(); });
    auto host = bodies_.host(n);
    const bool good = bodies_.call(host, nullptr, Phase::run, [&](void* ports, Context& context) {
        context.wanting([&](std::string_view output) {
            return target || results_.keeps(n) ||
                   std::ranges::any_of(readers_[n], [&](std::size_t reader) {
                       return io_.reads(reader, n, output);
                   });
        });
        if (behaviour.add && connected) behaviour.add(ports, context);
        if (behaviour.digest && connected)
            behaviour.add_digest(behaviour.digest(ports, context), context);
        if (behaviour.finish) finish_from_cached(host, ports, context);
        if (behaviour.run) behaviour.run(ports, context);
        held_[n] = io_.collect(n, ports);
    });
    end(host, good, true, 0);
}

void OnceCalls::finish(std::size_t n, std::size_t gathered) {
    const auto& behaviour = bodies_.behaviour(n);
    auto host = bodies_.host(n);
    const bool delivers = node(n).rate != Rate::frame;
    const bool good =
        bodies_.call(host, nullptr, Phase::finish, [&](void* ports, Context& context) {
            finish_from_cached(host, ports, context);
            if (!delivers) return;
            if (behaviour.run) behaviour.run(ports, context);
            held_[n] = io_.collect(n, ports);
        });
    end(host, good, delivers, gathered);
}

void OnceCalls::finish_from_cached(BodyHost& host, void* ports, Context& context) {
    const auto n = host.node;
    if (const auto& growth = node(n).type->growth;
        growth && node(n).kept && node(n).rate != Rate::frame) {
        host.grows();
        if (const auto part = results_.load_part(n)) {
            host.goes_on_from(growth->item_count(part->first));
            bodies_.behaviour(n).resume(part->first, part->second);
        }
    }
    bodies_.behaviour(n).finish(ports, context);
}

void OnceCalls::end(BodyHost& host, bool good, bool delivers, std::size_t gathered) {
    const auto n = host.node;
    setup_.events.once_body_ended(n, host.seconds(), io_.bytes(held_[n]), good);
    if (!good) bodies_.end_run();
    else if (delivers) results_.keep(host, 0, held_[n]);
    CostSetting at;
    at.gathered = gathered;
    const double share = good ? 1 : setup_.cancelled() ? host.share() : 0;
    if (share > 0) host.count_items(good && !held_[n].empty() ? &held_[n][0] : nullptr, at);
    setup_.events.once_call_ended(n, host.span, good, share, at);
}

void OnceCalls::lacks_frames(std::size_t n, const std::vector<int>& failed) {
    bodies_.fail(n, std::nullopt,
                 fmt::format("needs every frame of the sequence, but these failed: {}",
                             FrameSet(failed).text()),
                 Failure::Kind::data);
    bodies_.end_run();
}

void OnceCalls::load(std::size_t n) {
    auto loaded = results_.load(n, 0);
    if (!loaded) return;
    held_[n] = std::move(*loaded);
    setup_.events.holds(n, io_.bytes(held_[n]));
}

void OnceCalls::release(std::size_t n) {
    for (const auto source : io_.sources(n))
        if (readers_[source].erase(n) == 1 && readers_[source].empty()) held_[source].clear();
}

}  // namespace fluidcarve
