#include "runtime/flow/run_events.h"

namespace fluidcarve {

void RunEvents::begin(const Schedule& schedule) {
    node_work_ = work_of(schedule);
    steps_.assign(node_work_.size(), {});
    progress_.begin_again();
    for (std::size_t n = 0; n < node_work_.size(); ++n) {
        const auto add = [&](Work work, std::size_t runs) {
            if (runs > 0)
                steps_[n][static_cast<std::size_t>(work)] =
                    progress_.add({report_.name(n), runs, costs_.expected(n, work)});
        };
        add(Work::consume, node_work_[n].consumed_inputs);
        const bool finishes = schedule.gathers[n] != 0;
        add(Work::once, finishes || (node_work_[n].once && node_work_[n].runs == 0) ? 1 : 0);
        add(Work::frame, node_work_[n].runs);
    }
}

void RunEvents::body_ended(Work work, std::size_t node, std::size_t t, double seconds,
                           std::uint64_t bytes) {
    if (work == Work::consume) report_.consumed(node, t, seconds, bytes);
    else report_.ran(node, t, seconds, bytes);
}

void RunEvents::call_ended(Work work, std::size_t node, WorkTimes::Span& span, int frame,
                           bool good) {
    const auto seconds = span.end();
    const auto& all = node_work_[node];
    const auto times = work == Work::consume ? all.consumed_inputs : all.runs;
    const double abreast = options_.abreast(times);
    if (good) costs_.add(node, work, seconds, {.abreast = abreast, .cores = abreast});
    progress_.done(step(node, work).value(), seconds, frame);
}

void RunEvents::loaded(std::size_t node, WorkTimes::Span& span) {
    const double abreast = options_.abreast(node_work_[node].loads());
    costs_.add(node, Work::load, span.end(), {.abreast = abreast, .cores = abreast});
}

void RunEvents::advanced(std::size_t node, double share, double seconds) {
    if (const auto once = step(node, Work::once)) progress_.part(*once, share, seconds);
}

void RunEvents::once_call_ended(std::size_t node, WorkTimes::Span& span, bool good, double share,
                                CostSetting at) {
    // What was stopped counts by the share of its work that it had done, unless that is too little
    // to tell the rest.
    constexpr double least = 0.05;
    const auto seconds = span.end();
    at.abreast = options_.abreast(std::nullopt);
    at.cores = span.cores();
    if (share >= least) costs_.add(node, Work::once, seconds / share, at);
    if (good) progress_.done(step(node, Work::once).value(), seconds, std::nullopt);
}

void RunEvents::warned_at_once(std::size_t node, const std::string& message) {
    if (const auto line = report_.warn(node, message); !line.empty()) progress_.say(line);
}

}  // namespace fluidcarve
