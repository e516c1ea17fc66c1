#include "runtime/run/run.h"
#include "graph/text/json_text.h"
#include "runtime/keep/work_folder.h"

#include "carve/base/words.h"
#include "formats/file/output_file.h"
#include "graph/views/file_places.h"
#include "runtime/html/html_report.h"
#include "runtime/keep/history.h"
#include "runtime/run/conclusions.h"
#include "runtime/run/preparation.h"
#include "runtime/run/prerequisites.h"
#include "runtime/run/status.h"
#include "runtime/run/steps.h"
#include "runtime/tell/breakdown.h"
#include "runtime/tell/outcome.h"
#include "runtime/tell/terminal.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <thread>

namespace fluidcarve {
namespace {

/// Creates the first file of each writer and removes it again, so that a folder that can't be
/// written to fails before a long run.
void try_outputs(const Pipeline& pipeline, const std::vector<Share>& shares, int frame,
                 Report& report) {
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n) {
        const auto& node = pipeline.nodes[n];
        for (const auto& spec : node.type->params) {
            if (shares[n].runs == 0 || spec.shape.kind != Shape::Kind::output_path ||
                spec.path(node.params.get()).text().empty())
                continue;
            try {
                const OutputFile file(spec.path(node.params.get()).at(frame));
            } catch (const Failure& failure) {
                report.failed({node.name, node.type->name,
                               node.rate == Rate::frame ? std::optional(frame) : std::nullopt,
                               failure.what(), failure.kind});
            }
        }
    }
}

/// Whether all that was to do is done, so that there is nothing left to interrupt.
bool all_done(const Report& report, const std::vector<Share>& to_do) {
    const auto done = report.done();
    for (std::size_t n = 0; n < to_do.size(); ++n)
        if (done[n] < to_do[n].frames) return false;
    return true;
}

int exit_of(const Report& report, bool cancelled, bool stopped) {
    const auto faults = report.faults();
    if (cancelled) return exit_code::interrupted;
    if (faults.empty()) return exit_code::done;
    if (!stopped) return exit_code::some_frames_failed;
    const bool only_inputs = std::all_of(faults.begin(), faults.end(), [](const Fault& fault) {
        return fault.kind == Failure::Kind::input;
    });
    return only_inputs ? exit_code::input : exit_code::node_failed;
}

/// Prints failures, warnings, results and times.
/// @param told  warnings that are already printed
/// @param done  the last words of a run that is done
void tell_outcome(const Report& report, const RunRequest& request,
                  const nlohmann::ordered_json& summary, const std::vector<std::string>& told,
                  const std::string& done) {
    constexpr std::size_t most = 20;
    const auto faults = report.faults();
    for (std::size_t n = 0; n < std::min(most, faults.size()); ++n)
        tell("failed: " + to_text(faults[n]));
    if (faults.size() > most)
        tell(fmt::format("... and {} more; --report FILE.json lists them all",
                         faults.size() - most));
    if (request.quiet) return;
    for (const auto& warning : report.warnings())
        if (std::find(told.begin(), told.end(), warning) == told.end()) tell("warning: " + warning);
    for (const auto& line : report.lines()) tell(line);
    if (faults.empty() && summary["exit"] == exit_code::done) tell(done);
    if (summary["exit"] == exit_code::interrupted) tell(interrupted_text(request.options.cache));
    if (request.verbose)
        for (const auto& [name, node] : summary["nodes"].items())
            tell(fmt::format(
                "{:>10.3f} s  {:>13}  {:>10.1f} MB  {} ({})", node["wall_s"].get<double>(),
                counted(node["frames"].get<std::size_t>(), "frame"),
                node["bytes"].get<double>() / 1e6, name, node["type"].get<std::string>()));
}

/// Writes a text.
/// @param what  name of the file's kind, for messages
/// @return `code`, or another exit code if writing fails
int write_file(const char* what, const std::string& path, const std::string& text, int code) {
    try {
        OutputFile::write(path, text);
        return code;
    } catch (const Failure& failure) {
        tell(fmt::format("failed: {}: {}", what, failure.what()));
        return code == exit_code::done ? exit_code::node_failed : code;
    }
}

int code_of(const Failure& failure) {
    return failure.kind == Failure::Kind::input ? exit_code::input : exit_code::node_failed;
}

/// Adds to the manifest what the run read. @return the exit code
int save(Manifest& manifest, const RunRequest& request) {
    try {
        const auto [listed, added] = manifest.save();
        if (!request.quiet)
            tell(fmt::format("manifest {}: {} as it lists {}, {} added", request.manifest_path,
                             listed == 1 ? "1 file is" : fmt::format("{} files are", listed),
                             listed == 1 ? "it" : "them", added));
        return exit_code::done;
    } catch (const Failure& failure) {
        tell(fmt::format("failed: manifest: {}", failure.what()));
        return code_of(failure);
    }
}

/// Writes the report, the page and the profile, if requested. @return the exit code
int write_all(const Pipeline& pipeline, const Registry& registry, const RunRequest& request,
              const nlohmann::ordered_json& summary, const RunProfile& profile,
              std::filesystem::file_time_type start, int code) {
    if (!request.report_path.empty())
        code = write_file("report", request.report_path, json_text(summary, 2) + "\n", code);
    if (!request.profile_path.empty())
        code = write_file("profile", request.profile_path, profile.text(), code);
    if (request.html_path.empty()) return code;
    const auto files = written_files(pipeline, summary["frames"].get<std::vector<int>>(), summary,
                                     start, request.html_path);
    const auto when = fmt::format("{:%Y-%m-%d %H:%M}", fmt::localtime(std::time(nullptr)));
    return write_file("page", request.html_path,
                      to_html(pipeline, registry, request.sources, summary, files, when), code);
}

/// Why a task of a farm can't begin: it does not see the folder of its job, so that it would not
/// see the results of others. Empty: it does.
std::string fault_of_task_folder(const RunRequest& request,
                                 const std::function<bool()>& cancelled) {
    const auto folder =
        job_folder(request.options.work_folder, request.task.substr(0, request.task.find('/')));
    std::error_code error;
    const auto start = std::chrono::steady_clock::now();
    while (!std::filesystem::exists(folder, error)) {
        if (cancelled() || std::chrono::steady_clock::now() - start >
                               std::chrono::duration<double>(request.wait.value_or(0)))
            break;
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
    }
    if (std::filesystem::exists(folder, error)) return {};
    return fmt::format(
        "--task {}: there is no folder {}; share the work folder with this machine, or make the "
        "job again if it was cleaned",
        request.task, folder);
}

/// Executes a schedule. If a cached result is missing, makes a new schedule and tries again.
/// @param told  gets the warnings that are printed meanwhile
/// @return whether the run ended early
bool execute(const Pipeline& pipeline, const Registry& registry, const RunRequest& request,
             Preparation& prepared, Schedule schedule, Report& report, WorkTimes& costs,
             RunProfile* profile, const std::function<bool()>& cancelled,
             std::vector<std::string>& told) {
    constexpr int most_attempts = 4;
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                      static_cast<std::size_t>(request.options.threads));
    tbb::task_arena arena(request.options.threads);
    Progress progress(request.progress, std::max<std::size_t>(1, prepared.plan().passes.size()),
                      [&](const std::string& warning) {
                          if (!request.quiet) tell("warning: " + warning);
                          told.push_back(warning);
                      });
    for (int attempt = 1;; ++attempt) {
        bool stopped = true, lost = false;
        arena.execute([&] {
            Flow flow(pipeline, registry, prepared.inputs().timelines, request.options,
                      prepared.store(), prepared.guard(), report, progress, costs, profile,
                      cancelled);
            flow.run(prepared.plan(), schedule);
            stopped = flow.stopped();
            lost = flow.lost();
        });
        if (!lost || cancelled() || (!request.options.keep_going && !report.faults().empty()))
            return stopped;
        if (attempt == most_attempts) {
            const auto& node = pipeline.nodes.front();
            report.failed({node.name, node.type->name, std::nullopt,
                           fmt::format("results keep disappearing from the work folder '{}'; does "
                                       "something clean it? --no-cache runs without it",
                                       request.options.work_folder),
                           Failure::Kind::data});
            return true;
        }
        // The last attempt does not use the cache.
        schedule = attempt + 1 == most_attempts ? prepared.uncached_schedule()
                                                : prepared.careful_schedule();
    }
}

/// Reports a failure if results that `--to` asks for, which lie in the work folder alone, are not
/// there.
/// @return whether they are
bool keeps_what_was_asked(const Pipeline& pipeline, Preparation& prepared,
                          const RunRequest& request, Report& report) {
    if (request.wish.to.empty() || !request.options.cache) return true;
    const auto& plan = prepared.plan();
    auto fault = prepared.cache().fault();
    const auto left = shares(pipeline, plan, prepared.schedule(), prepared.uncached_schedule());
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n) {
        const auto& node = pipeline.nodes[n];
        const bool asked = plan.digested[n] ? digests_apart(node)
                                            : plan.targets[n] && node.kept && !pipeline.writes(n);
        if (!asked || (fault.empty() && left[n].runs == 0)) continue;
        if (fault.empty()) fault = prepared.fault_of_contents();
        if (fault.empty())
            fault = "they are not in the work folder; does something clean it? Run again";
        report.failed({node.name, node.type->name, std::nullopt,
                       "its results could not be kept for other runs: " + fault,
                       Failure::Kind::data});
        return false;
    }
    return true;
}

/// Stores the state of all nodes in the history, so that a later forecast can say what changed.
void remember(const Pipeline& pipeline, const Preparation& prepared,
              const std::vector<Share>& shares, History& history) {
    if (!history.on()) return;
    for (std::size_t n = 0; n < shares.size(); ++n)
        if (shares[n].frames > 0)
            history.set(pipeline.nodes[n].name,
                        History::made_of(pipeline, n, prepared.dependencies(), prepared.reads(n)));
    history.save();
}

void remember_costs(const Pipeline& pipeline, const Preparation& prepared, const WorkTimes& costs,
                    const Report& report, History& history) {
    if (!history.on()) return;
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n) {
        auto cost = costs.of(n);
        if (std::ranges::none_of(cost.of, [](const auto& each) { return each.has_value(); }))
            continue;
        cost.bytes = report.most_bytes(n);
        history.set_cost(pipeline.nodes[n].name, cost, prepared.inputs().frame_bytes);
    }
    history.save();
}

/// Whether the system grants the threads of a run; says so if it does not.
bool grants_threads(const RunRequest& request) {
    try {
        require_threads(request.options.threads);
        return true;
    } catch (const Failure& failure) {
        tell(fmt::format("failed: {}", failure.what()));
        return false;
    }
}

/// Warns of a work folder whose results could not be read.
void tell_of_unread(const Cache& cache) {
    if (const auto unread = cache.unread(); !unread.empty())
        tell("warning: results of earlier runs could not be used: " + unread);
}

/// Warns of damaged, unreadable or unwritable cache entries.
void tell_of_cache(const Cache& cache, const Report& report) {
    if (cache.damaged() > 0)
        tell(fmt::format("warning: {} damaged {} in the work folder {} computed again",
                         cache.damaged(), cache.damaged() == 1 ? "result" : "results",
                         cache.damaged() == 1 ? "was" : "were"));
    if (!report.faults().empty()) return;
    if (cache.fault().empty()) tell_of_unread(cache);
    else tell(fmt::format("warning: results could not be kept for other runs: {}", cache.fault()));
}

}  // namespace

int plan_pipeline(const Pipeline& pipeline, const Registry& registry, const RunRequest& request,
                  bool json) {
    if (!grants_threads(request)) return exit_code::node_failed;
    Report report(pipeline);
    Preparation prepared(pipeline, registry, request.options, request.wish, request.deliver,
                         report);
    if (!request.quiet)
        for (const auto& warning : report.warnings()) tell("warning: " + warning);
    for (const auto* faults : {&prepared.inputs().missing, &prepared.inputs().clashes})
        for (const auto& fault : *faults) report.failed(fault);
    for (const auto& fault : report.faults()) tell("failed: " + to_text(fault));
    if (!report.faults().empty() || prepared.frames().empty()) return exit_code::input;
    const auto schedule = prepared.schedule();
    const auto to_do = shares(pipeline, prepared.plan(), schedule, prepared.uncached_schedule());
    if (!request.quiet) tell_of_unread(prepared.cache());
    const History history(request.options.cache ? request.options.work_folder : std::string(),
                          pipeline.name);
    const auto forecast =
        make_forecast(pipeline, prepared, schedule, to_do, history, request.options);
    auto as_json = to_json(forecast);
    if (json)
        as_json["steps"] =
            to_json(steps_of(pipeline, registry, prepared, history, request.options));
    std::fputs(json ? (json_text(as_json, 2) + "\n").c_str() : to_text(forecast).c_str(), stdout);
    if (request.verbose && !json)
        std::fputs(("\n" + to_text(file_places(pipeline))).c_str(), stdout);
    return exit_code::done;
}

int run_pipeline(const Pipeline& pipeline, const Registry& registry, const RunRequest& request,
                 const std::function<bool()>& cancelled) {
    const auto start = std::filesystem::file_time_type::clock::now();
    OutputFile::sync_commits(request.options.sync);
    for (const auto& [what, path] :
         {std::pair("report", request.report_path), std::pair("page", request.html_path),
          std::pair("profile", request.profile_path)}) {
        try {
            if (!path.empty()) OutputFile::require_writable(path);
        } catch (const Failure& failure) {
            return tell(fmt::format("failed: {}: {}", what, failure.what())),
                   exit_code::node_failed;
        }
    }
    if (!grants_threads(request)) return exit_code::node_failed;
    const auto record = request.task.empty() ? std::string()
                                             : task_record(request.options.work_folder,
                                                           request.task, request.deliver);
    std::optional<Manifest> manifest;
    try {
        if (!request.manifest_path.empty()) manifest.emplace(request.manifest_path);
    } catch (const Failure& failure) {
        return tell(fmt::format("failed: manifest: {}", failure.what())), code_of(failure);
    }
    if (const auto fault =
            request.task.empty() ? std::string() : fault_of_task_folder(request, cancelled);
        !fault.empty())
        return tell("failed: " + fault), exit_code::input;
    Report report(pipeline);
    RunProfile profile(pipeline);
    try {
        if (request.options.cache) WorkFolder(request.options.work_folder).make();
    } catch (const Failure&) {
        // Results are then not kept; a message at the end says so.
    }
    Preparation prepared(pipeline, registry, request.options, request.wish, request.deliver, report,
                         manifest ? &*manifest : nullptr);
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n)
        if (prepared.plan().needed[n])
            for (const auto& warning : pipeline.nodes[n].warnings) report.warn(n, warning.message);
    if (!request.quiet)
        for (const auto& warning : report.warnings()) tell("warning: " + warning);
    auto told = report.warnings();
    // Missing files stop the run before it starts. With --keep-going the reader fails at its frame
    // instead.
    if (!request.options.keep_going)
        for (const auto& fault : prepared.inputs().missing) report.failed(fault);
    for (const auto& fault : prepared.inputs().clashes) report.failed(fault);
    for (const auto& fault : prepared.unlike_manifest()) report.failed(fault);
    if (prepared.frames().empty()) {
        const auto& [targets, digested] =
            std::tie(prepared.plan().targets, prepared.plan().digested);
        std::size_t first = 0;
        while (!targets[first] && !digested[first]) ++first;
        const auto& node = pipeline.nodes[first];
        report.failed(
            {node.name, node.type->name, std::nullopt,
             "no frame is left: every frame lacks a file of a reader with `missing: skip`",
             Failure::Kind::input});
    }

    const auto delivered = prepared.delivered_frames();
    bool stopped = true, idle = false, whole = false;
    std::vector<std::string> written;
    std::optional<std::size_t> frames;
    if (report.faults().empty()) {
        auto [schedule, to_do, absent] =
            wait_for_prerequisites(pipeline, prepared, request, cancelled);
        for (auto& fault : absent) report.failed(std::move(fault));
        prepared.repeat_said(schedule, report);
        // repeat_said found a damaged entry: its result must be computed again.
        if (prepared.cache().damaged() > 0) {
            schedule = prepared.careful_schedule();
            to_do = shares(pipeline, prepared.plan(), schedule, prepared.uncached_schedule());
        }
        History history(request.options.cache ? request.options.work_folder : std::string(),
                        pipeline.name);
        const auto forecast =
            make_forecast(pipeline, prepared, schedule, to_do, history, request.options);
        if (request.verbose)
            std::fputs((to_text(forecast) + to_text(file_places(pipeline))).c_str(), stderr);
        if (report.faults().empty() && !request.options.keep_going)
            try_outputs(pipeline, to_do,
                        (delivered.empty() ? prepared.frames() : delivered).front(), report);
        report.expect(to_do);
        if (report.faults().empty()) {
            remember(pipeline, prepared, to_do, history);
            StatusFile status(request.options.cache ? request.options.work_folder : std::string(),
                              forecast, report, record);
            WorkTimes costs(forecast.expected);
            idle = nothing_to_do(to_do);
            written = written_paths(pipeline, to_do);
            frames = written_frames(pipeline, to_do);
            stopped = execute(pipeline, registry, request, prepared, schedule, report, costs,
                              request.profile_path.empty() ? nullptr : &profile, cancelled, told);
            whole = all_done(report, to_do);
            prepared.cache().finish();
            if (report.faults().empty() && (whole || !cancelled()) &&
                !keeps_what_was_asked(pipeline, prepared, request, report))
                stopped = true;
            status.end(exit_of(report, cancelled() && !whole, stopped));
            remember_costs(pipeline, prepared, costs, report, history);
            conclude(pipeline, prepared.inputs().timelines, to_do, report);
            const auto left = prepared.cache().trim(request.options.cache_size).left;
            const auto fault = WorkFolder(request.options.work_folder).fault();
            if (left > request.options.cache_size && !fault.empty() && !request.quiet)
                tell(
                    fmt::format("warning: results take {}, more than --cache-size ({}), but can't "
                                "be removed: {}",
                                size_text(left), size_text(request.options.cache_size), fault));
        }
    }
    int code = exit_of(report, cancelled() && !whole, stopped);
    if (code != exit_code::done && !record.empty())
        StatusFile::record_failure(record, pipeline.name, delivered, report, code);
    if (manifest && code == exit_code::done) code = save(*manifest, request);
    const auto summary = report.to_json(delivered, code);
    if (!request.quiet) tell_of_cache(prepared.cache(), report);
    tell_outcome(report, request, summary, told,
                 done_text({frames.value_or(delivered.size()), summary["wall_s"].get<double>(),
                            idle, written}));
    return write_all(pipeline, registry, request, summary, profile, start, code);
}

}  // namespace fluidcarve
