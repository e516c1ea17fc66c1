#pragma once

#include "nodes/python/worker.h"

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace fluidcarve {

/// The program's workers. There come to be as many as frames in flight. A further one starts beside
/// those that work, so that nobody waits for its start who could have one of them before.
/// Thread-safe.
class Workers {
public:
    /// Which workers can stand in for each other: interpreter and script.
    using Kind = std::pair<std::string, std::string>;

    static Workers& of_program();
    ~Workers();

    /// Hands a worker to `use`. It is idle again afterwards, unless its process has ended.
    /// @param limits  of the import of the script
    /// @throws as Worker, and what `use` throws
    void with_one(const Kind& kind, const WorkerLimits& limits, const WorkerHost& host,
                  const std::function<void(Worker&)>& use);

private:
    struct Pool {
        std::vector<std::unique_ptr<Worker>> idle;
        std::size_t busy = 0, starting = 0, waiting = 0;
        bool can_start = true;  ///< none has failed to start beside others
    };
    /// An idle worker, or a new one; it counts as busy.
    std::unique_ptr<Worker> taken(const Kind& kind, const WorkerLimits& limits,
                                  const WorkerHost& host);
    void start_beside(const Kind& kind, const WorkerLimits& limits);

    std::mutex mutex_;
    std::condition_variable changed_;
    std::map<Kind, Pool> pools_;  ///< their places do not change
    std::atomic<bool> closing_ = false;
    std::vector<std::thread> starters_;
};

}  // namespace fluidcarve
