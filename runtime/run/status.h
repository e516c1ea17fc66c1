#pragma once

#include "runtime/run/forecast.h"
#include "runtime/tell/report.h"

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace fluidcarve {

/// While it lives, a file in the work folder says how far a run has come, anew each second, for `fluidcarve status`.
class StatusFile {
public:
    /// @param folder  the work folder; empty: nothing is written
    StatusFile(const std::string& folder, const Forecast& forecast, const Report& report);
    /// The run has ended.
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

/// The verb `status`: says on stdout of each run in a work folder, the latest first, what it is to do, what is done, and whether it runs,
/// has ended, or was killed. @return an exit code
int show_status(const std::string& folder, bool json);

}  // namespace fluidcarve
