#include "nodes/python/workers.h"

#include "carve/base/failure.h"

#include <chrono>

namespace fluidcarve {

Workers& Workers::of_program() {
    static Workers workers;
    return workers;
}

Workers::~Workers() {
    closing_ = true;
    for (auto& starter : starters_) starter.join();
}

void Workers::with_one(const Kind& kind, const WorkerLimits& limits, const WorkerHost& host,
                       const std::function<void(Worker&)>& use) {
    auto worker = taken(kind, limits, host);
    const auto give_back = [&] {
        const std::lock_guard lock(mutex_);
        auto& pool = pools_[kind];
        --pool.busy;
        if (worker->alive()) pool.idle.push_back(std::move(worker));
        changed_.notify_all();
    };
    try {
        use(*worker);
    } catch (...) {
        give_back();
        throw;
    }
    give_back();
}

std::unique_ptr<Worker> Workers::taken(const Kind& kind, const WorkerLimits& limits,
                                       const WorkerHost& host) {
    constexpr auto pause = std::chrono::milliseconds(50);
    std::unique_lock lock(mutex_);
    auto& pool = pools_[kind];
    while (true) {
        if (!pool.idle.empty()) {
            auto out = std::move(pool.idle.back());
            pool.idle.pop_back();
            ++pool.busy;
            return out;
        }
        if (pool.busy + pool.starting == 0) break;
        ++pool.waiting;
        if (pool.starting < pool.waiting && pool.can_start) start_beside(kind, limits);
        changed_.wait_for(lock, pause);
        --pool.waiting;
        if (host.cancelled()) throw Cancelled{};
    }
    ++pool.busy;
    lock.unlock();
    try {
        return std::make_unique<Worker>(kind.first, kind.second, limits, host);
    } catch (...) {
        lock.lock();
        --pool.busy;
        changed_.notify_all();
        throw;
    }
}

void Workers::start_beside(const Kind& kind, const WorkerLimits& limits) {
    ++pools_[kind].starting;
    starters_.emplace_back([this, kind, limits] {
        std::unique_ptr<Worker> made;
        WorkerHost host;
        host.cancelled = [this] { return closing_.load(); };
        try {
            made = std::make_unique<Worker>(kind.first, kind.second, limits, host);
        } catch (...) {
            // Running workers continue. If none is left, the next caller starts one itself, and
            // gets the failure.
        }
        const std::lock_guard lock(mutex_);
        auto& pool = pools_[kind];
        --pool.starting;
        if (made) pool.idle.push_back(std::move(made));
        else pool.can_start = false;
        changed_.notify_all();
    });
}

}  // namespace fluidcarve
