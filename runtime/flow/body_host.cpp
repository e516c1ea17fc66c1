#include "runtime/flow/body_host.h"

#include <optional>

namespace fluidcarve {

double BodyHost::seconds() const {
    return std::chrono::duration<double>(Clock::now() - start_).count();
}

void BodyHost::count_items(const Payload* result, CostSetting& at) {
    const auto& growth = of().type->growth;
    if (!growth) return;
    if (result) found_ = growth->item_count(*result);
    const auto all = result ? found_.count : wanted();
    at.items = all > before_.count ? all - before_.count : 0;
    at.all_items = found_.all_items;
}

void BodyHost::warn(const std::string& message) {
    setup_.events.warned(node, message);
    const std::lock_guard lock(mutex_);
    log.warnings.push_back(message);
}

void BodyHost::warn_at_once(const std::string& message) {
    setup_.events.warned_at_once(node, message);
    warn(message);
}

void BodyHost::report(const std::string& section, const nlohmann::ordered_json& entry) {
    setup_.events.reported(node, section, entry);
    const std::lock_guard lock(mutex_);
    log.report[section] = entry;
}

void BodyHost::progress(double share) {
    share_ = share;
    setup_.events.advanced(node, share, seconds());
}

void BodyHost::checkpoint(const Payload& result) {
    const std::lock_guard lock(mutex_);
    const auto begin = Clock::now();
    if (!grows_ || begin < next_checkpoint_) return;
    const auto event = setup_.events.event("keep", node, std::nullopt);
    setup_.store.keep_grown(node, 0, result, log, true);
    grew(of().type->growth->item_count(result));
    // Wait ten times as long as the write took, so that writing takes at most a tenth of the time.
    constexpr int pauses = 10;
    next_checkpoint_ = Clock::now() + pauses * (Clock::now() - begin);
}

void BodyHost::grew(const ItemCount& items) {
    found_ = items;
    setup_.events.grew(node, items.count, wanted());
}

std::size_t BodyHost::wanted() const {
    return of().type->growth->wanted(of().params.get(), found_.all_items);
}

}  // namespace fluidcarve
