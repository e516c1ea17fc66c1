#include "runtime/jobs/job_status.h"

#include "carve/base/frame_set.h"
#include "formats/file/input_file.h"
#include "formats/file/output_file.h"
#include "graph/text/json_text.h"
#include "graph/text/text_table.h"
#include "runtime/keep/work_folder.h"
#include "runtime/run/forecast.h"
#include "runtime/run/status.h"
#include "runtime/run/task.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <vector>

namespace fluidcarve {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Whether a value read from a file has the form that record_job writes.
bool is_job(const Json& job) {
    if (!job.is_object() || !has(job, "name", &Json::is_string) ||
        !has(job, "pipeline", &Json::is_string) || !has(job, "again", &Json::is_string) ||
        !has(job, "engine", &Json::is_string) || !has(job, "steps", &Json::is_array))
        return false;
    return std::ranges::all_of(job["steps"], [](const Json& step) {
        return step.is_object() && has(step, "name", &Json::is_string) &&
               has(step, "needs", &Json::is_array) &&
               has(step, "tasks", &Json::is_number_unsigned) &&
               (!step.contains("frames") || has(step, "frames", &Json::is_string));
    });
}

/// The status of a step, from the records of its tasks.
struct StepStatus {
    std::size_t running = 0, done = 0;  ///< tasks
    std::set<int> frames;               ///< of finished tasks
    std::vector<std::pair<std::string, Json>> failed;
};

/// Whether other tasks have since done the work of a failed task.
bool made_good(const Json& task, const StepStatus& step) {
    const auto frames = task.value("frames", std::vector<int>());
    return std::ranges::all_of(frames, [&](int frame) { return step.frames.contains(frame); });
}

/// The state of a step: "done", "running", "failed", "interrupted", "begun" or "waits".
std::string state_of(const StepStatus& step, std::size_t wanted, bool chunked) {
    if (chunked ? wanted > 0 && step.frames.size() >= wanted : step.done > 0) return "done";
    if (step.running > 0) return "running";
    if (std::ranges::any_of(step.failed,
                            [](const auto& each) { return each.second["state"] != "interrupted"; }))
        return "failed";
    if (!step.failed.empty()) return "interrupted";
    return step.done > 0 ? "begun" : "waits";
}

StepStatus status_of(const std::string& name, bool chunked, const std::vector<Json>& tasks) {
    StepStatus out;
    const auto called = [](const Json& task) {
        return fs::path(task["file"].get<std::string>()).stem().string();
    };
    const auto of_step = [&](const Json& task) {
        return called(task) == name || called(task).starts_with(name + ".");
    };
    for (const auto& task : tasks) {
        if (!of_step(task)) continue;
        out.running += task["state"] == "running" ? 1 : 0;
        if (task["state"] != "done") continue;
        ++out.done;
        for (const auto frame : task.value("frames", std::vector<int>())) out.frames.insert(frame);
    }
    for (const auto& task : tasks)
        if (of_step(task) && task["state"] != "running" && task["state"] != "done" &&
            !(chunked && made_good(task, out)))
            out.failed.emplace_back(called(task), task);
    return out;
}

/// The status of a job, as `status --json` prints it.
Json about(const Json& job, const std::string& folder) {
    const auto tasks = recorded_runs(folder + "/tasks");
    Json out{{"job", job["name"]}, {"pipeline", job["pipeline"]}, {"engine", job["engine"]},
             {"state", ""},        {"steps", Json::array()},      {"failures", Json::array()}};
    std::set<std::string> states;
    for (const auto& step : job["steps"]) {
        std::string fault;
        const bool chunked = step.contains("frames");
        const auto frames = chunked ? FrameSet::parse(step["frames"].get<std::string>(), fault)
                                          .value_or(FrameSet())
                                          .frames()
                                          .size()
                                    : 0;
        const auto status = status_of(step["name"], chunked, tasks);
        auto& entry = out["steps"].emplace_back(
            Json{{"name", step["name"]}, {"state", state_of(status, frames, chunked)}});
        if (chunked) entry.update({{"frames", status.frames.size()}, {"of_frames", frames}});
        entry.update({{"tasks_done", status.done},
                      {"tasks_running", status.running},
                      {"needs", step["needs"]}});
        states.insert(entry["state"]);
        for (const auto& [task, said] : status.failed)
            out["failures"].push_back({{"task", task},
                                       {"state", said["state"]},
                                       {"host", said["host"]},
                                       {"messages", said.value("faults", Json::array())}});
    }
    const auto any = [&](const char* state) { return states.contains(state); };
    out["state"] = any("running")       ? "running"
                   : any("failed")      ? "failed"
                   : any("interrupted") ? "interrupted"
                   : any("begun")       ? "begun"
                   : any("waits")       ? any("done") ? "begun" : "waits"
                                        : "done";
    out["again"] = job["again"];
    return out;
}

std::vector<Json> jobs_in(const std::string& work_folder) {
    std::vector<Json> out;
    std::error_code error;
    std::vector<fs::path> folders;
    for (fs::directory_iterator each(work_folder + "/jobs", error), end; !error && each != end;
         each.increment(error))
        folders.push_back(each->path());
    std::ranges::sort(folders);
    for (const auto& folder : folders) {
        const auto job = json_of_own_file(folder / "job.json");
        if (is_job(job)) out.push_back(about(job, folder.string()));
    }
    return out;
}

/// A list of step names for a table.
std::string joined(const Json& names) {
    std::string out;
    for (const auto& name : names) out += (out.empty() ? "" : ", ") + name.get<std::string>();
    return out;
}

std::string job_text(const Json& job) {
    auto out = fmt::format("{} ({}, {}): {}\n\n", job["job"].get<std::string>(),
                           job["pipeline"].get<std::string>(), job["engine"].get<std::string>(),
                           job["state"].get<std::string>());
    std::vector<std::vector<std::string>> rows{
        {"step", "state", "frames", "of", "running", "waits for"}};
    for (const auto& step : job["steps"]) {
        const bool chunked = step.contains("frames");
        rows.push_back({step["name"], step["state"], chunked ? step["frames"].dump() : "",
                        chunked ? step["of_frames"].dump() : "", step["tasks_running"].dump(),
                        joined(step["needs"])});
    }
    out += text_table(rows);
    for (const auto& failure : job["failures"]) {
        const auto task = failure["task"].get<std::string>();
        const auto& messages = failure["messages"];
        if (messages.empty())
            out += fmt::format("{}: {} on {}\n", failure["state"].get<std::string>(), task,
                               failure["host"].get<std::string>());
        for (const auto& message : messages)
            out +=
                fmt::format("failed: {}: {}\n", task,
                            message.is_string() ? message.get<std::string>() : json_text(message));
    }
    if (job["state"] != "done")
        out += fmt::format("to continue, run: {}\n", job["again"].get<std::string>());
    return out;
}

}  // namespace

void record_job(const FarmJob& job, const std::string& engine) {
    WorkFolder(job.work).make();
    auto about = to_json(job);
    about["engine"] = engine;
    OutputFile::write(job_folder(job.work, job.name) + "/job.json", json_text(about, 1) + "\n");
}

std::string job_status_text(const std::string& work_folder, bool json) {
    const auto jobs = jobs_in(work_folder);
    if (json) {
        auto out = Json(jobs);
        for (auto& run : recorded_runs(work_folder + "/runs")) out.push_back(std::move(run));
        return json_text(out, 2) + "\n";
    }
    std::string out;
    for (const auto& job : jobs) out += job_text(job) + "\n";
    if (!jobs.empty() && recorded_runs(work_folder + "/runs").empty()) return out;
    return out + status_text(work_folder);
}

}  // namespace fluidcarve
