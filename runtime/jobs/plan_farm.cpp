#include "runtime/jobs/plan_farm.h"

#include "carve/base/frame_set.h"
#include "carve/base/words.h"
#include "formats/file/content_hash.h"
#include "formats/file/full_path.h"
#include "formats/file/path_pattern.h"
#include "graph/views/file_places.h"
#include "runtime/keep/work_folder.h"
#include "runtime/run/preparation.h"
#include "runtime/run/steps.h"
#include "runtime/tell/terminal.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

namespace fluidcarve {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t frames_unmeasured = 10;  ///< frames of a task, if nothing was measured
constexpr double minutes_wanted = 10;          ///< wanted time of a task, by default
constexpr std::uint64_t program_bytes = std::uint64_t{256}
                                        << 20;  ///< memory of a run besides its data
constexpr double memory_margin = 1.25;

/// Most frames of a task.
std::size_t frames_of_task(const RunStep& step, const FarmChunking& chunking) {
    const auto all = step.frames.size();
    if (chunking.frames) return *chunking.frames;
    if (chunking.tasks) return (all + *chunking.tasks - 1) / *chunking.tasks;
    const auto one = step.resources(1), whole = step.resources(all);
    if (!one.seconds || !whole.seconds) return frames_unmeasured;
    const auto each =
        all > 1 ? (*whole.seconds - *one.seconds) / static_cast<double>(all - 1) : *one.seconds;
    const auto wanted = chunking.minutes.value_or(minutes_wanted) * 60 - (*one.seconds - each);
    if (!(each > 0) || wanted >= each * static_cast<double>(all)) return all;
    const auto most = static_cast<std::size_t>(std::max(1.0, std::floor(wanted / each)));
    // The same number of tasks, but all of about the same size.
    const auto tasks = (all + most - 1) / most;
    return (all + tasks - 1) / tasks;
}

/// What to ask of a farm: memory with a margin.
RunResources asked_for(RunResources needs) {
    if (needs.memory > 0)
        needs.memory =
            static_cast<std::uint64_t>(memory_margin * static_cast<double>(needs.memory)) +
            program_bytes;
    return needs;
}

/// All files and folders that the run reads and writes.
std::vector<FarmPath> paths_of(const Pipeline& pipeline, const std::string& work) {
    std::vector<FarmPath> out;
    for (std::size_t n = 0; n < pipeline.files.size(); ++n)
        out.push_back({n == 0 ? "pipeline" : fmt::format("pipeline {}", n + 1),
                       full_path(pipeline.files[n]).string(),
                       {},
                       false,
                       true,
                       false});
    std::set<std::string> plugins;
    for (const auto& [type, file] : pipeline.plugins) plugins.insert(full_path(file).string());
    for (const auto& file : plugins) out.push_back({"plugin", file, {}, false, true, false});
    for (const auto& place : file_places(pipeline)) {
        // An input that does not lie beside the pipeline is at its other place.
        const PathPattern pattern(
            place.writes || place.found || place.tried_at.empty() ? place.path : place.tried_at);
        fs::path path = pattern.text(), file;
        for (; PathPattern(path.string()).per_frame(); path = path.parent_path())
            file = file.empty() ? path.filename() : path.filename() / file;
        out.push_back({place.node + "." + place.field, path.string(), file.string(), !file.empty(),
                       !place.writes, place.writes});
    }
    out.push_back({"work", work, {}, true, true, true});
    return out;
}

/// A name that is the same for the same command, and differs for other commands.
std::string name_of(const FarmJob& job, const FarmCommand& command,
                    const std::vector<RunStep>& steps) {
    Hasher hash;
    hash.text(job.folder);
    for (const auto& [variable, value] : command.environment) hash.text(variable).text(value);
    for (const auto& word : command.pipeline) hash.text(word);
    for (const auto& step : steps) hash.text(step.target.to).text(FrameSet(step.frames).text());
    constexpr std::size_t digits = 6;
    auto stem = shot_of(job.pipeline);
    std::ranges::replace_if(
        stem, [](unsigned char c) { return !std::isalnum(c) && c != '-' && c != '_'; }, '_');
    return stem + "-" + hash.digest().text().substr(0, digits);
}

/// A step of a job, without its arguments.
FarmStep farm_step(const RunStep& step, const std::vector<RunStep>& steps,
                   const FarmChunking& chunking) {
    FarmStep out;
    out.name = step.name;
    out.what = step.what;
    out.chunked = step.chunked;
    for (const auto need : step.needs) out.needs.push_back(steps[need].name);
    out.tasks = step.chunked ? chunks_of(FrameSet(step.frames), frames_of_task(step, chunking))
                             : std::vector<FrameSet>(1);
    out.resources = asked_for(step.resources(out.tasks.front().frames().size()));
    return out;
}

/// A job without steps.
FarmJob job_of(const Pipeline& pipeline, const std::vector<RunStep>& steps,
               const RunRequest& request, const FarmCommand& command) {
    FarmJob out;
    out.pipeline = pipeline.name;
    out.folder = fs::current_path().string();
    if (!command.environment.empty()) out.prefix.emplace_back("env");
    for (const auto& [variable, value] : command.environment)
        out.prefix.push_back(fmt::format("{}={}", variable, value));
    out.prefix.insert(out.prefix.end(), command.prefix.begin(), command.prefix.end());
    out.executable = command.executable;
    out.work = request.options.work_folder;
    out.again = command.again;
    out.name = name_of(out, command, steps);
    out.paths = paths_of(pipeline, out.work);
    return out;
}

/// Warns of steps whose costs are not known, or too high for the work folder.
void warn_of_costs(const std::vector<RunStep>& steps, const FarmChunking& chunking,
                   std::uint64_t cache_size) {
    std::uint64_t kept = 0;
    std::vector<std::string> unmeasured;
    for (const auto& step : steps) {
        const auto whole = step.resources(step.frames.size());
        kept += whole.disk;
        if (step.chunked && !whole.seconds) unmeasured.push_back(step.name);
    }
    if (chunking.minutes && !unmeasured.empty())
        tell(fmt::format(
            "warning: --minutes {}: the time per frame is not measured yet in {}; {} a task",
            *chunking.minutes, fmt::join(unmeasured, ", "), counted(frames_unmeasured, "frame")));
    if (kept > cache_size)
        tell(
            fmt::format("warning: the steps write about {}, more than --cache-size ({}): a task "
                        "may find removed what another has made; raise --cache-size",
                        size_text(kept), size_text(cache_size)));
}

}  // namespace

std::optional<FarmJob> plan_farm(const Pipeline& pipeline, const Registry& registry,
                                 const RunRequest& request, const FarmChunking& chunking,
                                 const FarmCommand& command) {
    Report report(pipeline);
    // Without the work folder no input is hashed. The steps do not depend on its content.
    auto uncached = request;
    uncached.options.cache = false;
    const Preparation prepared(pipeline, registry, uncached, report);
    if (!request.quiet)
        for (const auto& warning : report.warnings()) tell("warning: " + warning);
    const auto failures = prepared.input_failures(false);
    for (const auto& failure : failures) tell("failed: " + to_text(failure));
    if (!failures.empty()) return std::nullopt;

    const History history(request.options.work_folder, pipeline.name);
    const auto steps = steps_of(pipeline, prepared, history, request.options);
    auto out = job_of(pipeline, steps, request, command);
    for (const auto& step : steps) {
        auto& made = out.steps.emplace_back(farm_step(step, steps, chunking));
        made.arguments = command.pipeline;
        made.arguments.insert(made.arguments.end(), command.options.begin(), command.options.end());
        made.arguments.insert(made.arguments.end(),
                              {step.target.only ? "--only" : "--to", step.target.to, "--task",
                               out.name + "/" + step.name});
    }
    warn_of_costs(steps, chunking, request.options.cache_size);
    return out;
}

}  // namespace fluidcarve
