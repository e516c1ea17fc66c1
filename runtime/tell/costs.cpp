#include "runtime/tell/costs.h"

#include <algorithm>

namespace fluidcarve {
namespace {

double seconds_between(std::chrono::steady_clock::time_point from,
                       std::chrono::steady_clock::time_point to) {
    return std::chrono::duration<double>(to - from).count();
}

/// Processor time of all threads, seconds.
double processor_seconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The part of a work that more threads do not speed up, 0..1.
double serial_part(const CostSetting& at) {
    // A run with one thread does not tell it.
    constexpr double unknown = 0.5;
    if (at.abreast <= 1) return unknown;
    return std::clamp((1 / std::max(1.0, at.cores) - 1 / at.abreast) / (1 - 1 / at.abreast), 0.0,
                      1.0);
}

double ratio(double now, double then) { return now > 0 && then > 0 ? now / then : 1; }

}  // namespace

double seconds_in(const WorkTime& cost, const CostSetting& now) {
    const auto& then = cost.at;
    const double serial = serial_part(then);
    const auto slowness = [&](double abreast) {
        return serial + (1 - serial) / std::max(1.0, abreast);
    };
    return cost.seconds *
           ratio(static_cast<double>(now.input_bytes), static_cast<double>(then.input_bytes)) *
           ratio(static_cast<double>(now.gathered), static_cast<double>(then.gathered)) *
           ratio(static_cast<double>(now.items), static_cast<double>(then.items)) *
           slowness(now.abreast) / slowness(then.abreast);
}

WorkTimes::Span::Span(WorkTimes& costs)
    : costs_(costs), start_(costs.enter()), cpu_start_(processor_seconds()) {}

double WorkTimes::Span::end() {
    if (!open_) return share_;
    open_ = false;
    share_ = costs_.leave() - start_;
    const double wall = seconds_between(wall_start_, std::chrono::steady_clock::now());
    cores_ = wall > 0 ? std::max(1.0, (processor_seconds() - cpu_start_) / wall) : 1;
    return share_;
}

void WorkTimes::advance() {
    const auto now = std::chrono::steady_clock::now();
    if (at_work_ > 0) shared_ += seconds_between(last_, now) / static_cast<double>(at_work_);
    last_ = now;
}

double WorkTimes::enter() {
    const std::lock_guard lock(mutex_);
    advance();
    ++at_work_;
    return shared_;
}

double WorkTimes::leave() {
    const std::lock_guard lock(mutex_);
    advance();
    --at_work_;
    return shared_;
}

void WorkTimes::add(std::size_t node, Work work, double seconds, const CostSetting& at) {
    const std::lock_guard lock(mutex_);
    auto& sum = sums_[node][static_cast<std::size_t>(work)];
    sum.seconds += seconds;
    ++sum.calls;
    sum.at = at;
}

std::optional<double> WorkTimes::expected(std::size_t node, Work work) const {
    const auto& cost = expected_[node][work];
    return cost ? std::optional(cost->seconds) : std::nullopt;
}

NodeCost WorkTimes::mean(std::size_t node) const {
    const std::lock_guard lock(mutex_);
    NodeCost out;
    for (std::size_t work = 0; work < work_kinds; ++work)
        if (const auto& sum = sums_[node][work]; sum.calls > 0)
            out.by_work[work] = WorkTime{sum.seconds / static_cast<double>(sum.calls), sum.at};
    return out;
}

}  // namespace fluidcarve
