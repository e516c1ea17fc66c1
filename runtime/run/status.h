#pragma once

#include "runtime/run/forecast.h"
#include "runtime/tell/report.h"

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace fluidcarve {

/// Writes the status of a run to a file in the work folder, every second during its lifetime, for
/// `fluidcarve status`.
class StatusFile {
public:
    /// @param folder  the work folder; empty: no file
    /// @param record  the file, if the run is a task of a farm (task_record); empty: a new file,
    ///   and old ones are removed
    StatusFile(const std::string& folder, const Forecast& forecast, const Report& report,
               const std::string& record);
    /// Writes the final status.
    void end(int exit_code);
    ~StatusFile();
    StatusFile(const StatusFile&) = delete;
    StatusFile& operator=(const StatusFile&) = delete;

    /// Replaces the record of a task by its failures; it may have failed before it had a record.
    /// @param frames  that it was to deliver
    static void record_failure(const std::string& record, const std::string& pipeline,
                               const std::vector<int>& frames, const Report& report, int exit_code);

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

/// The status of the runs whose files lie in a folder, latest first, as pipelines/FORMATS.md says;
/// a task that failed has its "faults", too.
std::vector<nlohmann::ordered_json> recorded_runs(const std::string& folder);

/// What the verb `status` prints: each run in a work folder, latest first: its nodes, how much of
/// each is done, the progress of gathering nodes, and whether the run is running, has ended, or was
/// killed.
std::string status_text(const std::string& folder);

}  // namespace fluidcarve
