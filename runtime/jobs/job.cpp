#include "runtime/jobs/job.h"

#include "carve/base/find_or_null.h"
#include "carve/base/words.h"
#include "graph/text/shell_word.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace fluidcarve {
namespace {

/// All frames of a step.
FrameSet all_frames(const FarmStep& step) {
    std::vector<int> out;
    for (const auto& task : step.tasks)
        out.insert(out.end(), task.frames().begin(), task.frames().end());
    return FrameSet(std::move(out));
}

/// "about 1.2 min, 4 cores, 2.3 GB, writes 1.2 GB".
std::string to_text(const RunResources& resources) {
    std::vector<std::string> out;
    if (resources.seconds > 0) out.push_back("about " + duration_text(*resources.seconds));
    if (resources.cores > 0)
        out.push_back(counted(static_cast<std::size_t>(resources.cores), "core"));
    if (resources.memory > 0) out.push_back("memory " + size_text(resources.memory));
    if (resources.disk > 0) out.push_back("writes " + size_text(resources.disk));
    return fmt::format("{}", fmt::join(out, ", "));
}

}  // namespace

const FarmStep* FarmJob::find(const std::string& step) const {
    return find_or_null(steps, step, &FarmStep::name);
}

std::size_t FarmJob::tasks() const {
    std::size_t out = 0;
    for (const auto& step : steps) out += step.tasks.size();
    return out;
}

std::vector<std::string> command_of(const FarmJob& job, const FarmStep& step,
                                    const FrameSet& task) {
    auto out = job.prefix;
    out.push_back(job.executable);
    out.insert(out.end(), step.arguments.begin(), step.arguments.end());
    if (!task.frames().empty()) out.push_back("--frames=" + task.text());
    return out;
}

std::vector<FrameSet> chunks_of(const FrameSet& frames, std::size_t most) {
    std::vector<FrameSet> out;
    const auto& all = frames.frames();
    for (std::size_t begin = 0; begin < all.size(); begin += most) {
        const auto end = std::min(all.size(), begin + most);
        out.push_back(FrameSet({all.begin() + static_cast<std::ptrdiff_t>(begin),
                                all.begin() + static_cast<std::ptrdiff_t>(end)}));
    }
    return out;
}

std::string to_text(const FarmJob& job) {
    auto out = fmt::format("{}: {}, {}\n", job.name, counted(job.steps.size(), "step"),
                           counted(job.tasks(), "task"));
    for (const auto& step : job.steps) {
        out += fmt::format("\n{}: {}\n", step.name, step.what);
        if (!step.needs.empty())
            out += fmt::format("  waits for {}\n", fmt::join(step.needs, ", "));
        if (step.chunked)
            out += fmt::format("  frames {} in {}\n", all_frames(step).text(),
                               counted(step.tasks.size(), "task"));
        out += fmt::format("  a task: {}\n  {}\n", to_text(step.resources),
                           shell_line(command_of(job, step, step.tasks.front())));
    }
    return out;
}

nlohmann::ordered_json to_json(const FarmJob& job) {
    nlohmann::ordered_json out{{"name", job.name},
                               {"pipeline", job.pipeline},
                               {"folder", job.folder},
                               {"again", job.again},
                               {"steps", nlohmann::ordered_json::array()}};
    for (const auto& step : job.steps) {
        auto& entry = out["steps"].emplace_back(nlohmann::ordered_json{
            {"name", step.name}, {"what", step.what}, {"needs", step.needs}});
        if (step.chunked) entry["frames"] = all_frames(step).text();
        entry.update({{"tasks", step.tasks.size()},
                      {"cores", step.resources.cores},
                      {"memory", step.resources.memory},
                      {"disk", step.resources.disk},
                      {"command", command_of(job, step, step.tasks.front())}});
        if (step.resources.seconds > 0) entry["seconds"] = *step.resources.seconds;
    }
    return out;
}

}  // namespace fluidcarve
