#include "runtime/run.h"

#include "graph/output_file.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <set>

namespace fluidcarve {
namespace {

/// fmt's own print throws where stderr is a file on a full disk.
void tell(const std::string& text) { std::fputs((text + "\n").c_str(), stderr); }

/// What the readers say of their files before anything runs.
class SurveyOf : public Survey {
public:
    /// @param needed  nothing: all of them
    SurveyOf(const std::vector<int>& frames, const std::optional<FrameSet>& needed, std::set<std::string, std::less<>> wanted)
        : frames_(frames), needed_(needed), wanted_(std::move(wanted)) {}
    const std::vector<int>& frames() const override { return frames_; }
    bool needs(int frame) const override { return !needed_ || needed_->contains(frame); }
    bool wants(std::string_view output) const override { return wanted_.contains(output); }
    void leave_out(int frame) override { left_out.insert(frame); }
    void missing(int frame, const std::string& message) override { lost.emplace_back(frame, message); }
    void warn(const std::string& message) override { warnings.push_back(message); }

    std::set<int> left_out;
    std::vector<std::pair<int, std::string>> lost;
    std::vector<std::string> warnings;

private:
    const std::vector<int>& frames_;
    const std::optional<FrameSet>& needed_;
    const std::set<std::string, std::less<>> wanted_;
};

/// Names of a node's outputs that the nodes of a run read.
std::set<std::string, std::less<>> wanted_outputs(const Pipeline& pipeline, const std::vector<bool>& needed, std::size_t node) {
    std::set<std::string, std::less<>> out;
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n)
        for (const auto& links : pipeline.nodes[n].inputs)
            for (const auto& link : links)
                if (needed[n] && link.node == node) out.insert(pipeline.nodes[node].outputs[link.output].name);
    return out;
}

struct Inputs {
    std::vector<int> frames;  ///< the sequence without the frames that readers leave out
    std::vector<Fault> missing;
};

/// @param needed       as flags: the nodes that run
/// @param in_sequence  as flags: those that run for every frame of the sequence, not only for the delivered ones
Inputs survey(const Pipeline& pipeline, const std::vector<bool>& needed, const std::vector<bool>& in_sequence, const std::optional<FrameSet>& deliver,
              Report& report) {
    Inputs out;
    std::set<int> left_out;
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n) {
        const auto& node = pipeline.nodes[n];
        if (!needed[n] || !node.type->survey) continue;
        const std::vector<int> once{pipeline.frames.frames().front()};
        const std::optional<FrameSet> read = node.rate == Rate::fixed || in_sequence[n] ? std::nullopt : deliver;
        SurveyOf of(node.rate == Rate::fixed ? once : pipeline.frames.frames(), read, wanted_outputs(pipeline, needed, n));
        node.type->survey(node.params.get(), of);
        for (const auto& warning : of.warnings) report.warn(n, warning);
        for (const auto& [frame, message] : of.lost)
            if (of.needs(frame))
                out.missing.push_back(
                    {node.name, node.type->name, node.rate == Rate::fixed ? std::nullopt : std::optional(frame), message, Failure::Kind::input});
        std::vector<int> asked;
        for (const auto frame : of.left_out)
            if (deliver && deliver->contains(frame)) asked.push_back(frame);
        if (!asked.empty()) report.warn(n, fmt::format("left out for want of a file, though -f names them: {}", FrameSet(asked).text()));
        left_out.insert(of.left_out.begin(), of.left_out.end());
    }
    for (const auto frame : pipeline.frames.frames())
        if (!left_out.contains(frame)) out.frames.push_back(frame);
    return out;
}

/// Where a writer's first file can't be written, no other likely can: told before hours are spent.
void try_outputs(const Pipeline& pipeline, const std::vector<bool>& needed, int frame, Report& report) {
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n) {
        const auto& node = pipeline.nodes[n];
        for (const auto& spec : node.type->params) {
            if (!needed[n] || spec.shape.kind != Shape::Kind::output_path || spec.path(node.params.get()).text().empty()) continue;
            try {
                const OutputFile file(spec.path(node.params.get()).at(frame));
            } catch (const Failure& failure) {
                report.failed({node.name, node.type->name, node.rate == Rate::frame ? std::optional(frame) : std::nullopt, failure.what(), failure.kind});
            }
        }
    }
}

int exit_of(const Report& report, bool cancelled, bool stopped) {
    const auto faults = report.faults();
    if (cancelled) return exit_code::interrupted;
    if (faults.empty()) return exit_code::done;
    if (!stopped) return exit_code::some_frames_failed;
    const bool only_inputs = std::all_of(faults.begin(), faults.end(), [](const Fault& fault) { return fault.kind == Failure::Kind::input; });
    return only_inputs ? exit_code::input : exit_code::node_failed;
}

/// @param told  warnings that the user has seen
void tell_outcome(const Report& report, const RunRequest& request, const nlohmann::ordered_json& summary, const std::vector<std::string>& told) {
    constexpr std::size_t most = 20;
    const auto faults = report.faults();
    for (std::size_t n = 0; n < std::min(most, faults.size()); ++n) tell("failed: " + to_text(faults[n]));
    if (faults.size() > most) tell(fmt::format("... and {} more; --report FILE.json lists them all", faults.size() - most));
    if (request.quiet) return;
    for (const auto& warning : report.warnings())
        if (std::find(told.begin(), told.end(), warning) == told.end()) tell("warning: " + warning);
    if (faults.empty() && summary["exit"] == exit_code::done)
        tell(fmt::format("done: {} frames in {:.1f} s", summary["frames"].size(), summary["wall_s"].get<double>()));
    if (request.verbose)
        for (const auto& [name, node] : summary["nodes"].items())
            tell(fmt::format("{:>10.3f} s  {:>6} frames  {:>10.1f} MB  {} ({})", node["wall_s"].get<double>(), node["frames"].get<std::size_t>(),
                             node["bytes"].get<double>() / 1e6, name, node["type"].get<std::string>()));
}

int write_report(const std::string& path, const nlohmann::ordered_json& report, int code) {
    try {
        OutputFile file(path);
        std::ofstream out(file.aside(), std::ios::binary);
        out << report.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << "\n";
        out.close();
        if (!out) throw Failure(fmt::format("cannot write {}: is the disk full?", path));
        file.commit();
        return code;
    } catch (const Failure& failure) {
        tell(fmt::format("failed: report: {}", failure.what()));
        return code == exit_code::done ? exit_code::node_failed : code;
    }
}

/// Runs the plan part by part. @return whether it was stopped before its end
bool execute(Flow& flow, const Plan& plan, const std::vector<bool>& delivered, Progress& progress) {
    flow.announce(plan, delivered);
    for (std::size_t p = 0; p < plan.passes.size() && !flow.stopped(); ++p) {
        progress.begin_pass(p);
        flow.run_once(plan.passes[p].before);
        if (!flow.stopped()) flow.run_pass(plan.passes[p], delivered, plan.targets);
    }
    if (!flow.stopped()) flow.run_once(plan.after);
    return flow.stopped();
}

}  // namespace

int run_pipeline(const Pipeline& pipeline, const Registry& registry, const RunRequest& request, const std::function<bool()>& cancelled) {
    try {
        if (!request.report_path.empty()) const OutputFile file(request.report_path);
    } catch (const Failure& failure) {
        return tell(fmt::format("failed: report: {}", failure.what())), exit_code::node_failed;
    }
    Report report(pipeline);
    const auto plan = make_plan(pipeline, request.to);
    std::vector<std::size_t> targets;
    for (std::size_t n = 0; n < plan.targets.size(); ++n)
        if (plan.targets[n]) targets.push_back(n);
    std::vector<bool> in_sequence(pipeline.nodes.size(), false);
    for (const auto& pass : plan.passes)
        for (const auto& needs : pass.gatherer_needs)
            for (std::size_t n = 0; n < needs.size(); ++n) in_sequence[n] = in_sequence[n] || needs[n];
    auto inputs = survey(pipeline, pipeline.upstream_of(targets), in_sequence, request.deliver, report);
    if (!request.quiet)
        for (const auto& warning : report.warnings()) tell("warning: " + warning);
    const auto told = report.warnings();
    // What is missing is told before hours are spent. With --keep-going the reader fails at its frame instead.
    if (!request.options.keep_going)
        for (auto& fault : inputs.missing) report.failed(std::move(fault));
    if (inputs.frames.empty())
        report.failed({pipeline.nodes[targets.front()].name, pipeline.nodes[targets.front()].type->name, std::nullopt,
                       "no frame is left: of each, some reader that leaves out missing frames has no file", Failure::Kind::input});

    std::vector<bool> delivered;
    std::vector<int> delivered_frames;
    for (const auto frame : inputs.frames) {
        delivered.push_back(!request.deliver || request.deliver->contains(frame));
        if (delivered.back()) delivered_frames.push_back(frame);
    }
    if (request.verbose) std::fputs(to_text(plan, pipeline, delivered_frames.size()).c_str(), stderr);

    if (report.faults().empty() && !request.options.keep_going)
        try_outputs(pipeline, pipeline.upstream_of(targets), (delivered_frames.empty() ? inputs.frames : delivered_frames).front(), report);

    bool stopped = true;
    if (report.faults().empty()) {
        const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(request.options.threads));
        tbb::task_arena arena(request.options.threads);
        Progress progress(request.progress, std::max<std::size_t>(1, plan.passes.size()));
        arena.execute([&] {
            Flow flow(pipeline, registry, inputs.frames, request.options, report, progress, cancelled);
            stopped = execute(flow, plan, delivered, progress);
        });
    }
    const int code = exit_of(report, cancelled(), stopped);
    const auto summary = report.to_json(delivered_frames, code);
    tell_outcome(report, request, summary, told);
    return request.report_path.empty() ? code : write_report(request.report_path, summary, code);
}

}  // namespace fluidcarve
