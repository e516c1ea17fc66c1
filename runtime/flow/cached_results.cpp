#include "runtime/flow/cached_results.h"

namespace fluidcarve {

std::optional<int> CachedResults::frame_of(std::size_t n, std::size_t t) const {
    return node(n).rate == Rate::frame ? std::optional(setup_.timelines.frames()[t]) : std::nullopt;
}

std::optional<std::vector<Payload>> CachedResults::load(std::size_t n, std::size_t t) {
    const auto event = setup_.events.event("load", n, frame_of(n, t));
    auto work = setup_.events.work();
    auto outputs = setup_.store.result(n, t);
    if (outputs) setup_.events.loaded(n, work);
    else lost_ = true;
    return outputs;
}

std::optional<Payload> CachedResults::load_digest(std::size_t n, std::size_t t) {
    const auto event = setup_.events.event("load", n, setup_.timelines.frames()[t]);
    auto work = setup_.events.work();
    auto digest = setup_.store.digest(n, t);
    if (!digest) lost_ = true;
    setup_.events.loaded(n, work);
    return digest;
}

std::optional<std::pair<Payload, nlohmann::ordered_json>> CachedResults::load_part(std::size_t n) {
    const auto event = setup_.events.event("load", n, std::nullopt);
    return setup_.store.part(n);
}

void CachedResults::keep(const BodyHost& host, std::size_t t, const std::vector<Payload>& outputs) {
    const auto n = host.node;
    const bool stores = setup_.options.cache && (node(n).kept || !host.log.empty());
    const auto event = setup_.events.event("keep", n, frame_of(n, t), stores);
    setup_.store.keep(n, t, outputs, host.log);
}

void CachedResults::keep_digest(const BodyHost& host, std::size_t t, const Payload& digest) {
    const auto n = host.node;
    const bool stores = setup_.options.cache && node(n).digests_kept;
    const auto event = setup_.events.event("keep", n, setup_.timelines.frames()[t], stores);
    setup_.store.keep_digest(n, t, digest, host.log);
}

}  // namespace fluidcarve
