#pragma once

#include "runtime/run/forecast.h"
#include "runtime/tell/report.h"

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace fluidcarve {

/// Writes the status of a run to a file in the work folder, every second during its lifetime, for `fluidcarve status`.
class StatusFile {
public:
    /// @param folder  the work folder; empty: no file
    StatusFile(const std::string& folder, const Forecast& forecast, const Report& report);
    /// Writes the final status.
    void end(int exit_code);
    ~StatusFile();
    StatusFile(const StatusFile&) = delete;
    StatusFile& operator=(const StatusFile&) = delete;

private:
    void write(const int* exit_code) const;

    std::string path_;
    nlohmann::ordered_json about_;
    const Report& report_;
    std::mutex mutex_;
    std::condition_variable ended_;
    bool end_ = false;
    std::thread thread_;
};

/// What the verb `status` prints: each run in a work folder, latest first: its nodes, how much of each is done, how far those are that gather,
/// and whether the run is running, has ended, or was killed. @param json  as JSON, for programs
std::string status_text(const std::string& folder, bool json);

}  // namespace fluidcarve
