#include "nodes/python/workers.h"

namespace fluidcarve {

Workers& Workers::of_program() {
    static Workers workers;
    return workers;
}

void Workers::with_one(const Kind& kind, double seconds, const WorkerHost& host, const std::function<void(Worker&)>& use) {
    std::unique_ptr<Worker> worker;
    {
        const std::lock_guard lock(mutex_);
        auto& idle = idle_[kind];
        if (!idle.empty()) {
            worker = std::move(idle.back());
            idle.pop_back();
        }
    }
    if (!worker) worker = std::make_unique<Worker>(kind.first, kind.second, seconds, host);
    const auto give_back = [&] {
        if (!worker->alive()) return;
        const std::lock_guard lock(mutex_);
        idle_[kind].push_back(std::move(worker));
    };
    try {
        use(*worker);
    } catch (...) {
        give_back();
        throw;
    }
    give_back();
}

}  // namespace fluidcarve
