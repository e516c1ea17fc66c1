#include "runtime/flow/flow.h"

#include "runtime/flow/pass_graph.h"

namespace fluidcarve {

void Flow::run(const Plan& plan, const Schedule& schedule) {
    setup_.events.begin(schedule);
    for (std::size_t pass = 0; pass < plan.passes.size() && !stopped(); ++pass) {
        setup_.events.begin_pass(pass);
        run_once(plan.passes[pass].before, plan, schedule);
        if (!stopped()) run_pass(pass, plan, schedule);
    }
    if (!stopped()) run_once(plan.after, plan, schedule);
}

void Flow::run_once(const std::vector<std::size_t>& nodes, const Plan& plan,
                    const Schedule& schedule) {
    for (const auto n : nodes) {
        if (stopped()) return;
        if (schedule.once[n] == Schedule::Action::run) once_.once(n, plan.targets[n]);
        if (schedule.once[n] == Schedule::Action::load) once_.load(n);
        once_.release(n);
    }
}

void Flow::run_pass(std::size_t number, const Plan& plan, const Schedule& schedule) {
    const auto& pass = plan.passes[number];
    const auto [count, failed] =
        PassGraph(setup_, bodies_, results_, {number, plan, schedule}).stream();
    for (const auto n : pass.gathering) {
        if (stopped()) return;
        if (schedule.once[n] == Schedule::Action::load) once_.load(n);
        if (!schedule.gathers[n]) continue;
        if (failed[n].empty()) once_.finish(n, count[n]);
        else once_.lacks_frames(n, failed[n]);
    }
}

}  // namespace fluidcarve
