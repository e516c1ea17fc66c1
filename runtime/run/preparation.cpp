#include "runtime/run/preparation.h"

#include "carve/base/frame_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

namespace fluidcarve {
namespace {

std::vector<bool> delivered_of(const std::vector<int>& frames,
                               const std::optional<FrameSet>& deliver) {
    std::vector<bool> out;
    for (const auto frame : frames) out.push_back(!deliver || deliver->contains(frame));
    return out;
}

/// Paths of the files that the run will read, if none is missing.
std::vector<std::string> files_to_read(const Pipeline& pipeline, const Plan& plan,
                                       const std::optional<FrameSet>& deliver) {
    std::vector<std::string> out;
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n) {
        const auto& node = pipeline.nodes[n];
        if (!plan.needed[n]) continue;
        const bool all = node.rate != Rate::frame || plan.in_sequence[n] || !deliver;
        for (const auto frame : node.frames.frames()) {
            if (all || deliver->contains(frame))
                std::ranges::move(named_files(node, frame), std::back_inserter(out));
            if (node.rate != Rate::frame) break;
        }
    }
    return out;
}

std::string folder_of(const RunOptions& options, const char* part) {
    return options.cache ? options.work_folder + part : std::string();
}

}  // namespace

Preparation::Preparation(const Pipeline& pipeline, const Registry& registry,
                         const RunRequest& request, Report& report, Manifest* manifest)
    : pipeline_(pipeline),
      plan_(make_plan(pipeline, request.target)),
      guard_(manifest, files_to_read(pipeline, plan_, request.target.frames)),
      inputs_(survey_inputs(pipeline, plan_, request.target.frames, request.options.cache, report)),
      delivered_(delivered_of(frames(), request.target.frames)),
      uncached_schedule_(make_uncached_schedule()),
      cache_(registry, folder_of(request.options, "")),
      files_(folder_of(request.options, "/files")),
      dependencies_(pipeline, inputs_.timelines, inputs_.stand_ins, files_),
      keys_(pipeline, dependencies_, [this](std::size_t n, std::size_t t) { return takes(n, t); }),
      store_(pipeline, dependencies_, keys_, cache_, files_),
      grown_(pipeline.nodes.size()) {
    for (const auto& [node, message] : foresee(pipeline, plan_.needed, inputs_.regions).warnings)
        report.warn(node, message);
    if (!cache_.on()) return;
    std::vector<std::string> paths;
    each_file([&](std::size_t, std::size_t, const std::string& path) { paths.push_back(path); });
    files_.prepare(paths);
    if (!frames().empty() && inputs_.missing.empty())
        for (std::size_t n = 0; n < grown_.size(); ++n)
            if (plan_.needed[n]) grown_[n] = store_.grown(n);
    if (manifest) compare(*manifest);
}

void Preparation::each_file(const std::function<void(std::size_t node, std::size_t t,
                                                     const std::string& path)>& see) const {
    for (std::size_t n = 0; n < pipeline_.nodes.size(); ++n) {
        const auto read = reads(n);
        for (std::size_t t = 0; t < read.size(); ++t) {
            if (!read[t]) continue;
            for (const auto& path : dependencies_.files(n, t)) see(n, t, path);
            if (pipeline_.nodes[n].rate != Rate::frame) break;
        }
    }
}

std::vector<NodeFailure> Preparation::input_failures(bool keep_going) const {
    std::vector<NodeFailure> out;
    if (!keep_going) out = inputs_.missing;
    std::ranges::copy(inputs_.clashes, std::back_inserter(out));
    std::ranges::copy(unlike_manifest_, std::back_inserter(out));
    if (!frames().empty()) return out;
    std::size_t first = 0;
    while (!plan_.targets[first] && !plan_.digested[first]) ++first;
    const auto& node = pipeline_.nodes[first];
    out.push_back(
        failure_in(node, std::nullopt,
                   "no frame is left: every frame lacks a file of a reader with `missing: skip`",
                   Failure::Kind::input));
    return out;
}

std::string Preparation::fault_of_contents() {
    std::string out;
    each_file([&](std::size_t, std::size_t, const std::string& path) {
        if (out.empty() && !files_.content(path))
            out = fmt::format(
                "{} could not be read when the run began, so that nothing tells its content; run "
                "again",
                path);
    });
    return out;
}

void Preparation::compare(Manifest& manifest) {
    each_file([&](std::size_t n, std::size_t t, const std::string& path) {
        const auto& node = pipeline_.nodes[n];
        try {
            if (const auto content = files_.content(path))
                manifest.require(path, {content->hash, content->size});
        } catch (const Failure& failure) {
            const auto frame = node.rate == Rate::frame ? std::optional(frames()[t]) : std::nullopt;
            unlike_manifest_.push_back(failure_in(node, frame, failure.what(), failure.kind));
        }
    });
}

std::vector<bool> Preparation::reads(std::size_t n) const {
    std::vector<bool> out(frames().size(), plan_.needed[n]);
    if (!plan_.needed[n] || pipeline_.nodes[n].rate != Rate::frame) return out;
    for (std::size_t t = 0; t < out.size(); ++t)
        out[t] = delivers(n, t) && (plan_.in_sequence[n] || delivered_[t]);
    return out;
}

bool Preparation::delivers(std::size_t n, std::size_t t) const {
    return inputs_.timelines.delivered(n).index[t].has_value();
}

bool Preparation::takes(std::size_t n, std::size_t t) const {
    static Context::Host silent;
    const auto& [frames, index] = inputs_.timelines.input_frames(n);
    if (!index[t]) return false;
    Context where(silent, frames);
    const auto& takes = pipeline_.nodes[n].traits.takes;
    return !takes || takes(where.at(*index[t]));
}

std::vector<int> Preparation::delivered_frames() const {
    std::vector<int> out;
    for (std::size_t t = 0; t < frames().size(); ++t)
        if (delivered_[t]) out.push_back(frames()[t]);
    return out;
}

Schedule Preparation::schedule() { return schedule(false); }
Schedule Preparation::careful_schedule() { return schedule(true); }

Schedule Preparation::schedule(bool careful) {
    std::map<std::pair<std::size_t, std::size_t>, bool> results, digests;
    const auto once = [](auto& known, std::size_t n, std::size_t t, const auto& find) {
        const auto [found, fresh] = known.try_emplace({n, t}, false);
        if (fresh) found->second = find();
        return found->second;
    };
    const ScheduleQueries known{
        [&](std::size_t n, std::size_t t) {
            return once(results, n, t,
                        [&] { return careful ? store_.knows_intact(n, t) : store_.knows(n, t); });
        },
        [&](std::size_t n, std::size_t t) {
            return once(digests, n, t, [&] {
                return careful ? store_.knows_intact_digest(n, t) : store_.knows_digest(n, t);
            });
        },
        [this](std::size_t n, std::size_t t) { return takes(n, t); },
        [this](std::size_t n, std::size_t t) { return delivers(n, t); },
        [&](std::size_t n, std::size_t t) {
            return !careful && cache_.on() && static_cast<bool>(keys_.entry(n, t));
        }};
    return make_schedule(pipeline_, plan_, delivered_, known);
}

Schedule Preparation::make_uncached_schedule() const {
    const auto nothing = [](std::size_t, std::size_t) { return false; };
    return make_schedule(
        pipeline_, plan_, delivered_,
        {nothing, nothing, [this](std::size_t n, std::size_t t) { return takes(n, t); },
         [this](std::size_t n, std::size_t t) { return delivers(n, t); }, nothing});
}

void Preparation::repeat_logs(const Schedule& schedule, Report& report) {
    if (!cache_.on()) return;
    const auto& uncached = uncached_schedule_;
    const auto runs_once = [](const Schedule& in, std::size_t n) {
        return in.once[n] == Schedule::Action::run;
    };
    const auto repeat = [&](std::size_t n, const NodeLog& log) {
        for (const auto& warning : log.warnings) report.warn(n, warning);
        for (const auto& [section, entry] : log.report) report.entry(n, section, entry);
    };
    for (std::size_t n = 0; n < pipeline_.nodes.size(); ++n) {
        const auto& node = pipeline_.nodes[n];
        const auto now = working_frames(schedule, n), anew = working_frames(uncached, n);
        const bool once = runs_once(uncached, n) && !runs_once(schedule, n);
        for (std::size_t t = 0; t < frames().size(); ++t) {
            if (node.type->digest != typeid(void) && anew.consumed_inputs.contains(t) &&
                !now.consumed_inputs.contains(t))
                repeat(n, store_.log_of_digest(n, t));
            if ((once && t == 0) || (anew.run.contains(t) && !now.run.contains(t)))
                repeat(n, store_.log(n, t));
        }
    }
}

}  // namespace fluidcarve
