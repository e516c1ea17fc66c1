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

/// The program's workers. Their number grows to that of frames in flight. Further workers start in
/// the background, so that a caller can take a worker that becomes idle before the new one has
/// started. Thread-safe.
class Workers {
public:
    /// Workers of one kind are interchangeable: interpreter and script.
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
        bool can_start = true;  ///< false once a worker has failed to start in the background
    };
    /// An idle worker, or a new one; it counts as busy.
    std::unique_ptr<Worker> taken(const Kind& kind, const WorkerLimits& limits,
                                  const WorkerHost& host);
    void start_beside(const Kind& kind, const WorkerLimits& limits);

    std::mutex mutex_;
    std::condition_variable changed_;
    std::map<Kind, Pool> pools_;  ///< references to pools stay valid
    std::atomic<bool> closing_ = false;
    std::vector<std::thread> starters_;
};

}  // namespace fluidcarve
