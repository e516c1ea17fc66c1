#include "runtime/run/status.h"

#include "formats/file/input_file.h"
#include "formats/file/output_file.h"
#include "graph/text/json_text.h"
#include "graph/text/text_table.h"
#include "runtime/keep/work_folder.h"
#include "runtime/tell/exit_codes.h"

#include <fmt/format.h>

#include <signal.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <vector>

namespace fluidcarve {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Seconds without an update after which a run on another machine counts as killed.
constexpr double silent_seconds = 30;
/// Number of ended runs whose status files stay in the work folder.
constexpr std::size_t most_ended = 10;

double now() {
    return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch())
        .count();
}

std::string host() {
    std::array<char, 256> name{};
    gethostname(name.data(), name.size() - 1);
    return name.data();
}

/// State of a run: "running", "done", "failed", "interrupted" or "killed".
std::string state_of(const Json& run) {
    if (run.contains("exit"))
        return run["exit"] == exit_code::done          ? "done"
               : run["exit"] == exit_code::interrupted ? "interrupted"
                                                       : "failed";
    if (run.value("host", "") == host())
        return kill(run.value("pid", 0), 0) == 0 || errno == EPERM ? "running" : "killed";
    return now() - run.value("updated", 0.0) < silent_seconds ? "running" : "killed";
}

/// Whether a value read from a file has the form that StatusFile writes.
bool well_formed(const Json& run) {
    if (!run.is_object() || !has(run, "pid", &Json::is_number_integer) ||
        !has(run, "started", &Json::is_number) || !has(run, "updated", &Json::is_number) ||
        !has(run, "host", &Json::is_string) || !has(run, "pipeline", &Json::is_string) ||
        !has(run, "nodes", &Json::is_object))
        return false;
    for (const auto& [name, node] : run["nodes"].items())
        if (!node.is_object() || !has(node, "type", &Json::is_string) ||
            !has(node, "frames", &Json::is_number) || !has(node, "cached", &Json::is_number) ||
            (node.contains("why") && !node["why"].is_string()) ||
            (node.contains("item") && !node["item"].is_string()))
            return false;
    return true;
}

/// Adds the process that writes a status file to it.
void sign(Json& about) {
    about["host"] = host();
    about["pid"] = getpid();
    about["started"] = now();
}

void write_status(const std::string& path, const Json& about) {
    try {
        OutputFile::write(path, json_text(about, 1) + "\n");
    } catch (const Failure&) {
        // The run goes on without a status file.
    }
}

/// The failures as lines of text.
Json faults_of(const Report& report) {
    auto out = Json::array();
    for (const auto& failure : report.failures()) out.push_back(to_text(failure));
    return out;
}

/// Progress of a gathering node: "16/16 frames gathered, 7/12 seams, interrupted"; empty if it
/// gathers nothing, or has finished.
/// @param state  of the run
std::string text_of_gathering(const Json& node, const std::string& state) {
    const auto of = node.find("gathering");
    if (of == node.end() || !of->is_object()) return {};
    const auto share = [&](const char* done, const char* all) {
        return fmt::format("{}/{}", of->at(done).dump(), of->at(all).dump());
    };
    std::string out;
    if (has(*of, "frames", &Json::is_number) && has(*of, "of_frames", &Json::is_number))
        out = share("frames", "of_frames") + " frames gathered";
    if (has(*of, "items", &Json::is_number) && has(*of, "of_items", &Json::is_number) &&
        of->at("of_items") > 0)
        out += fmt::format(", {} {}s", share("items", "of_items"), node.value("item", "item"));
    return state == "running" ? out : out + ", " + state;
}

/// "shot.yaml: done, 12 s, process 4711 on render7".
std::string head_of(const Json& run) {
    const double seconds = run.value("updated", 0.0) - run.value("started", 0.0);
    return fmt::format("{}: {}, {:.0f} s, process {} on {}\n", run.value("pipeline", ""),
                       run.value("state", ""), seconds, run.value("pid", 0), run.value("host", ""));
}

std::string run_text(const Json& run) {
    auto out = head_of(run) + "\n";
    std::vector<std::vector<std::string>> rows{
        {"node", "type", "frames", "cached", "done", "gathering", "why it runs"}};
    constexpr int column = 5;  ///< of "gathering", which is left out if it is empty
    bool gathers = false;
    for (const auto& [name, node] : run["nodes"].items()) {
        rows.push_back({name, node.value("type", ""), node["frames"].dump(), node["cached"].dump(),
                        node.value("done", Json(0)).dump(),
                        text_of_gathering(node, run.value("state", "")), node.value("why", "")});
        gathers = gathers || !rows.back()[column].empty();
    }
    if (!gathers)
        for (auto& row : rows) row.erase(row.begin() + column);
    return out + text_table(rows);
}

}  // namespace

StatusFile::StatusFile(const std::string& folder, const Forecast& forecast, const Report& report,
                       const std::string& record)
    : about_(to_json(forecast)), report_(report) {
    if (folder.empty()) return;
    const auto runs = folder + "/runs";
    sign(about_);
    if (!record.empty()) {
        path_ = record;
    } else {
        auto former = recorded_runs(runs);
        std::erase_if(former, [](const Json& run) { return run["state"] == "running"; });
        std::error_code ignored;
        for (std::size_t n = most_ended; n < former.size(); ++n)
            fs::remove(former[n]["file"].get<std::string>(), ignored);
        path_ = fmt::format("{}/{}.{}.{}.{:.0f}.json", runs, shot_of(forecast.pipeline), host(),
                            getpid(), now() * 1000);
    }
    thread_ = std::thread([this] {
        std::unique_lock lock(mutex_);
        while (!end_) {
            write(nullptr);
            ended_.wait_for(lock, std::chrono::seconds(1));
        }
    });
}

void StatusFile::end(int exit_code) {
    if (!thread_.joinable()) return;
    {
        const std::lock_guard lock(mutex_);
        end_ = true;
    }
    ended_.notify_all();
    thread_.join();
    write(&exit_code);
}

StatusFile::~StatusFile() {
    if (thread_.joinable()) end(1);
}

void StatusFile::write(const int* exit_code) const {
    auto out = about_;
    out["updated"] = now();
    if (exit_code) out["exit"] = *exit_code;
    const auto done = report_.done();
    for (std::size_t n = 0; n < done.size(); ++n)
        if (const auto name = report_.name(n); out["nodes"].contains(name)) {
            out["nodes"][name]["done"] = done[n];
            if (const auto far = report_.gathering(n))
                out["nodes"][name]["gathering"] = {{"frames", far->frames},
                                                   {"of_frames", far->of_frames},
                                                   {"items", far->items},
                                                   {"of_items", far->of_items}};
        }
    write_status(path_, out);
}

void StatusFile::record_failure(const std::string& record, const std::string& pipeline,
                                const std::vector<int>& frames, const Report& report,
                                int exit_code) {
    auto about = json_of_own_file(record);
    if (!well_formed(about) || about["pid"] != getpid() || about["host"] != host()) {
        about = {{"pipeline", pipeline}, {"frames", frames}, {"nodes", Json::object()}};
        sign(about);
    }
    about["updated"] = now();
    about["exit"] = exit_code;
    about["faults"] = faults_of(report);
    write_status(record, about);
}

std::vector<Json> recorded_runs(const std::string& folder) {
    std::vector<Json> out;
    std::error_code error;
    for (fs::directory_iterator each(folder, error), end; !error && each != end;
         each.increment(error)) {
        if (each->path().extension() != ".json" ||
            each->path().filename().string().starts_with('.'))
            continue;
        auto about = json_of_own_file(each->path());
        if (!well_formed(about)) continue;
        about["state"] = state_of(about);
        about["file"] = each->path().string();
        out.push_back(std::move(about));
    }
    std::ranges::stable_sort(out, [](const Json& a, const Json& b) {
        return a.value("started", 0.0) > b.value("started", 0.0);
    });
    return out;
}

std::string status_text(const std::string& folder) {
    const auto runs = recorded_runs(folder + "/runs");
    if (runs.empty()) return fmt::format("no runs are recorded in '{}'\n", folder);
    // Live runs in full, or the last run; all others as a line.
    std::string out, others;
    const bool alive =
        std::ranges::any_of(runs, [](const Json& run) { return run["state"] == "running"; });
    for (const auto& run : runs) {
        const bool whole = alive ? run["state"] == "running" : &run == &runs.front();
        if (whole) out += (out.empty() ? "" : "\n") + run_text(run);
        else others += head_of(run);
    }
    return out + (others.empty() ? "" : "\nearlier:\n" + others);
}

}  // namespace fluidcarve
