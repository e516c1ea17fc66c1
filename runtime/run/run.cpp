#include "runtime/run/run.h"

#include "carve/base/words.h"
#include "formats/file/output_file.h"
#include "graph/text/json_text.h"
#include "graph/views/file_places.h"
#include "runtime/flow/flow.h"
#include "runtime/keep/history.h"
#include "runtime/keep/work_folder.h"
#include "runtime/run/conclusions.h"
#include "runtime/run/preparation.h"
#include "runtime/run/prerequisites.h"
#include "runtime/run/run_end.h"
#include "runtime/run/status.h"
#include "runtime/run/steps.h"
#include "runtime/run/task.h"
#include "runtime/tell/outcome.h"
#include "runtime/tell/terminal.h"
#include "runtime/tell/uncaught.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {
namespace {

/// Creates the first file of each writer and removes it again, so that a folder that can't be
/// written to fails before a long run.
void try_outputs(const Pipeline& pipeline, const std::vector<NodeDemand>& demands, int frame,
                 Report& report) {
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n) {
        if (demands[n].computed == 0) continue;
        const auto& node = pipeline.nodes[n];
        for (const auto& [param, path] : node.written()) {
            try {
                const OutputFile file(path.at(frame));
            } catch (const Failure& failure) {
                report.failed(
                    failure_in(node, node.rate == Rate::frame ? std::optional(frame) : std::nullopt,
                               failure.what(), failure.kind));
            }
        }
    }
}

/// Whether all work is done, so that nothing is left to interrupt.
bool all_done(const Report& report, const std::vector<NodeDemand>& to_do) {
    const auto done = report.done();
    for (std::size_t n = 0; n < to_do.size(); ++n)
        if (done[n] < to_do[n].needed) return false;
    return true;
}

int exit_of(const Report& report, bool cancelled, bool stopped) {
    const auto failures = report.failures();
    if (cancelled) return exit_code::interrupted;
    if (failures.empty()) return exit_code::done;
    if (!stopped) return exit_code::some_frames_failed;
    const bool only_inputs = std::ranges::all_of(
        failures, [](const NodeFailure& failure) { return failure.kind == Failure::Kind::input; });
    return only_inputs ? exit_code::input : exit_code::node_failed;
}

/// Reports a failure if results that `--to` asks for, which only the work folder holds, are
/// missing.
/// @return whether they exist
bool keeps_what_was_asked(const Pipeline& pipeline, Preparation& prepared,
                          const RunRequest& request, Report& report) {
    if (request.target.to.empty() || !request.options.cache) return true;
    const auto& plan = prepared.plan();
    auto fault = prepared.cache().fault();
    const auto left = prepared.demands(prepared.schedule());
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n) {
        const auto& node = pipeline.nodes[n];
        const bool asked = plan.digested[n] ? digests_apart(node)
                                            : plan.targets[n] && node.kept && !pipeline.writes(n);
        if (!asked || (fault.empty() && left[n].computed == 0)) continue;
        if (fault.empty()) fault = prepared.fault_of_contents();
        if (fault.empty())
            fault = "they are not in the work folder; does something clean it? Run again";
        report.failed(failure_in(node, std::nullopt,
                                 "its results could not be kept for other runs: " + fault,
                                 Failure::Kind::data));
        return false;
    }
    return true;
}

/// Stores the state of all nodes in the history, so that a later forecast can say what changed.
void remember(const Pipeline& pipeline, const Preparation& prepared,
              const std::vector<NodeDemand>& demands, History& history) {
    if (!history.on()) return;
    for (std::size_t n = 0; n < demands.size(); ++n)
        if (demands[n].needed > 0)
            history.set(pipeline.nodes[n].name,
                        History::made_of(pipeline, n, prepared.dependencies(), prepared.reads(n)));
    history.save();
}

void remember_costs(const Pipeline& pipeline, const Preparation& prepared, const WorkTimes& costs,
                    const Report& report, History& history) {
    if (!history.on()) return;
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n) {
        auto cost = costs.mean(n);
        if (std::ranges::none_of(cost.by_work, [](const auto& each) { return each.has_value(); }))
            continue;
        cost.bytes = report.most_bytes(n);
        history.set_cost(pipeline.nodes[n].name, cost, prepared.inputs().frame_bytes);
    }
    history.save();
}

/// Whether the system grants the threads of a run; prints a failure if it does not.
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
void tell_of_read_fault(const Cache& cache) {
    if (const auto fault = cache.read_fault(); !fault.empty())
        tell("warning: results of earlier runs could not be used: " + fault);
}

/// Warns of damaged, unreadable or unwritable cache entries.
void tell_of_cache(const Cache& cache, const Report& report) {
    if (cache.damaged() > 0)
        tell(fmt::format("warning: {} damaged {} in the work folder {} computed again",
                         cache.damaged(), cache.damaged() == 1 ? "result" : "results",
                         cache.damaged() == 1 ? "was" : "were"));
    if (!report.failures().empty()) return;
    if (cache.fault().empty()) tell_of_read_fault(cache);
    else tell(fmt::format("warning: results could not be kept for other runs: {}", cache.fault()));
}

}  // namespace

int plan_pipeline(const Pipeline& pipeline, const Registry& registry, const RunRequest& request,
                  bool json) {
    if (!grants_threads(request)) return exit_code::node_failed;
    Report report(pipeline);
    Preparation prepared(pipeline, registry, request, report);
    if (!request.quiet)
        for (const auto& warning : report.warnings()) tell("warning: " + warning);
    for (const auto& failure : prepared.input_failures(false)) report.failed(failure);
    for (const auto& failure : report.failures()) tell("failed: " + to_text(failure));
    if (!report.failures().empty()) return exit_code::input;
    const auto schedule = prepared.schedule();
    const auto to_do = prepared.demands(schedule);
    if (!request.quiet) tell_of_read_fault(prepared.cache());
    const History history(request.options.cache ? request.options.work_folder : std::string(),
                          pipeline.name);
    const auto forecast =
        make_forecast(pipeline, prepared, schedule, to_do, history, request.options);
    auto as_json = to_json(forecast);
    if (json) as_json["steps"] = to_json(steps_of(pipeline, prepared, history, request.options));
    std::fputs(json ? (json_text(as_json, 2) + "\n").c_str() : to_text(forecast).c_str(), stdout);
    if (request.verbose && !json)
        std::fputs(("\n" + to_text(file_places(pipeline))).c_str(), stdout);
    return exit_code::done;
}

namespace {

/// A run, from its first message to its exit code.
class PipelineRun {
public:
    PipelineRun(const Pipeline& pipeline, const Registry& registry, const RunRequest& request,
                const std::function<bool()>& cancelled)
        : pipeline_(pipeline), registry_(registry), request_(request), cancelled_(cancelled) {}

    /// @return the exit code
    int run() {
        OutputFile::sync_commits(request_.options.sync);
        if (const auto code = refusal()) return *code;
        // Their clocks start here: the time that a task waits for its folder does not count.
        report_.emplace(pipeline_);
        profile_.emplace(pipeline_);
        try {
            if (request_.options.cache) WorkFolder(request_.options.work_folder).make();
        } catch (const Failure&) {
            // Results are then not kept; a message at the end says so.
        }
        Preparation prepared(pipeline_, registry_, request_, *report_,
                             manifest_ ? &*manifest_ : nullptr);
        warn(prepared);
        for (const auto& failure : prepared.input_failures(request_.options.keep_going))
            report_->failed(failure);
        if (report_->failures().empty()) deliver(prepared);
        return end(prepared);
    }

private:
    /// Prints why the run can't begin, and returns the exit code; nothing: it can begin.
    std::optional<int> refusal() {
        for (const auto& [what, path] :
             {std::pair("report", request_.report_path), std::pair("page", request_.html_path),
              std::pair("profile", request_.profile_path)}) {
            try {
                if (!path.empty()) OutputFile::require_writable(path);
            } catch (const Failure& failure) {
                tell(fmt::format("failed: {}: {}", what, failure.what()));
                return exit_code::node_failed;
            }
        }
        if (!grants_threads(request_)) return exit_code::node_failed;
        try {
            if (!request_.manifest_path.empty()) manifest_.emplace(request_.manifest_path);
        } catch (const Failure& failure) {
            tell(fmt::format("failed: manifest: {}", failure.what()));
            return exit_code::of(failure);
        }
        if (!request_.task) return std::nullopt;
        record_ = task_record(request_.options.work_folder, *request_.task, request_.target.frames);
        const auto fault = fault_of_task_folder(request_, cancelled_);
        if (fault.empty()) return std::nullopt;
        tell("failed: " + fault);
        return exit_code::input;
    }

    /// Prints the warnings before the run.
    void warn(const Preparation& prepared) {
        for (std::size_t n = 0; n < pipeline_.nodes.size(); ++n)
            if (prepared.plan().needed[n])
                for (const auto& warning : pipeline_.nodes[n].warnings)
                    report_->warn(n, warning.message);
        told_ = report_->warnings();
        if (request_.quiet) return;
        for (const auto& warning : told_) tell("warning: " + warning);
    }

    /// Computes and writes what is missing.
    void deliver(Preparation& prepared) {
        auto [schedule, to_do, absent] =
            wait_for_prerequisites(pipeline_, prepared, request_, cancelled_);
        for (auto& failure : absent) report_->failed(std::move(failure));
        prepared.repeat_logs(schedule, *report_);
        // repeat_logs found a damaged entry: its result must be computed again.
        if (prepared.cache().damaged() > 0) {
            schedule = prepared.careful_schedule();
            to_do = prepared.demands(schedule);
        }
        History history(work_folder(), pipeline_.name);
        const auto forecast =
            make_forecast(pipeline_, prepared, schedule, to_do, history, request_.options);
        if (request_.verbose)
            std::fputs((to_text(forecast) + to_text(file_places(pipeline_))).c_str(), stderr);
        if (report_->failures().empty() && !request_.options.keep_going)
            try_outputs(pipeline_, to_do, delivered(prepared).front(), *report_);
        report_->expect(to_do);
        if (!report_->failures().empty()) return;
        remember(pipeline_, prepared, to_do, history);
        idle_ = nothing_to_do(to_do);
        written_ = written_paths(pipeline_, to_do);
        frames_ = written_frames(pipeline_, to_do);
        StatusFile status(work_folder(), forecast, *report_, record_);
        WorkTimes costs(forecast.expected);
        stopped_ = execute(prepared, schedule, costs);
        whole_ = all_done(*report_, to_do);
        prepared.cache().finish();
        if (report_->failures().empty() && (whole_ || !cancelled_()) &&
            !keeps_what_was_asked(pipeline_, prepared, request_, *report_))
            stopped_ = true;
        status.end(code());
        remember_costs(pipeline_, prepared, costs, *report_, history);
        conclude(pipeline_, prepared.inputs().timelines, to_do, *report_);
        trim(prepared);
    }

    /// Executes a schedule. If a cached result is missing, makes a new schedule and tries again.
    /// @return whether the run ended early
    bool execute(Preparation& prepared, Schedule schedule, WorkTimes& costs) {
        constexpr int most_attempts = 4;
        const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                          static_cast<std::size_t>(request_.options.threads));
        tbb::task_arena arena(request_.options.threads);
        Progress progress(request_.progress,
                          std::max<std::size_t>(1, prepared.plan().passes.size()),
                          [&](const std::string& warning) {
                              if (!request_.quiet) tell("warning: " + warning);
                              told_.push_back(warning);
                          });
        RunEvents events(request_.options, *report_, progress, costs,
                         request_.profile_path.empty() ? nullptr : &*profile_);
        for (int attempt = 1;; ++attempt) {
            bool stopped = true, lost = false;
            arena.execute([&] {
                Flow flow({.pipeline = pipeline_,
                           .registry = registry_,
                           .timelines = prepared.inputs().timelines,
                           .options = request_.options,
                           .store = prepared.store(),
                           .guard = prepared.guard(),
                           .events = events,
                           .cancelled = cancelled_});
                flow.run(prepared.plan(), schedule);
                stopped = flow.stopped();
                lost = flow.lost();
            });
            if (!lost || cancelled_() ||
                (!request_.options.keep_going && !report_->failures().empty()))
                return stopped;
            if (attempt == most_attempts) {
                const auto& node = pipeline_.nodes.front();
                report_->failed(failure_in(
                    node, std::nullopt,
                    fmt::format("results keep disappearing from the work folder '{}'; does "
                                "something clean it? --no-cache runs without it",
                                request_.options.work_folder),
                    Failure::Kind::data));
                return true;
            }
            // The last attempt does not use the cache.
            schedule = attempt + 1 == most_attempts ? prepared.uncached_schedule()
                                                    : prepared.careful_schedule();
        }
    }

    /// Removes results that were not used for longest, and warns if they can't be.
    void trim(Preparation& prepared) const {
        const auto left = prepared.cache().trim(request_.options.cache_size).left;
        const auto fault = WorkFolder(request_.options.work_folder).fault();
        if (left > request_.options.cache_size && !fault.empty() && !request_.quiet)
            tell(
                fmt::format("warning: results take {}, more than --cache-size ({}), but can't be "
                            "removed: {}",
                            size_text(left), size_text(request_.options.cache_size), fault));
    }

    /// Prints the outcome, and writes the reports of a run. @return the exit code
    int end(Preparation& prepared) {
        const auto frames = prepared.delivered_frames();
        int code = this->code();
        if (code != exit_code::done && !record_.empty())
            StatusFile::record_failure(record_, pipeline_.name, frames, *report_, code);
        if (manifest_ && code == exit_code::done) code = save_manifest(*manifest_, request_);
        const auto summary = report_->to_json(frames, code);
        if (!request_.quiet) tell_of_cache(prepared.cache(), *report_);
        tell_outcome(*report_, request_, summary, told_,
                     done_text({frames_.value_or(frames.size()), summary["wall_s"].get<double>(),
                                idle_, written_}));
        return write_reports(pipeline_, registry_, request_, summary, *profile_, start_, code);
    }

    int code() const { return exit_of(*report_, cancelled_() && !whole_, stopped_); }
    /// Empty: no results are kept.
    std::string work_folder() const {
        return request_.options.cache ? request_.options.work_folder : std::string();
    }
    /// The delivered frames, at least one.
    static std::vector<int> delivered(const Preparation& prepared) {
        auto out = prepared.delivered_frames();
        return out.empty() ? prepared.frames() : out;
    }

    const Pipeline& pipeline_;
    const Registry& registry_;
    const RunRequest& request_;
    const std::function<bool()>& cancelled_;
    const std::filesystem::file_time_type start_ = std::filesystem::file_time_type::clock::now();
    std::optional<Report> report_;
    std::optional<RunProfile> profile_;
    std::optional<Manifest> manifest_;
    std::string record_;             ///< status file of a farm task; empty: the run is not a task
    std::vector<std::string> told_;  ///< printed warnings
    /// Whether the run ended early; had nothing to do; did all its work.
    bool stopped_ = true, idle_ = false, whole_ = false;
    std::vector<std::string> written_;   ///< paths
    std::optional<std::size_t> frames_;  ///< number of frames that are written
};

}  // namespace

int run_pipeline(const Pipeline& pipeline, const Registry& registry, const RunRequest& request,
                 const std::function<bool()>& cancelled) {
    return PipelineRun(pipeline, registry, request, cancelled).run();
}

}  // namespace fluidcarve
