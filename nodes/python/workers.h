#pragma once

#include "nodes/python/worker.h"

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

/// The program's workers that nobody calls at present. There come to be as many as frames in flight. Thread-safe.
class Workers {
public:
    /// Which workers can stand in for each other: interpreter and script.
    using Kind = std::pair<std::string, std::string>;

    static Workers& of_program();

    /// Hands a worker to `use`: an idle one, else a new one. It is idle again afterwards, unless its process has ended.
    /// @param seconds  that the import of the script may take
    /// @throws as Worker, and what `use` throws
    void with_one(const Kind& kind, double seconds, const WorkerHost& host, const std::function<void(Worker&)>& use);

private:
    std::mutex mutex_;
    std::map<Kind, std::vector<std::unique_ptr<Worker>>> idle_;
};

}  // namespace fluidcarve
