#include "runtime/run/task.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

namespace fluidcarve {

std::optional<JobStep> JobStep::parse(const std::string& text) {
    const auto named = [](const std::string& name) {
        return !name.empty() && std::ranges::all_of(name, [](unsigned char c) {
            return std::isalnum(c) || c == '-' || c == '_';
        });
    };
    const auto slash = text.find('/');
    if (slash == std::string::npos) return std::nullopt;
    JobStep out{text.substr(0, slash), text.substr(slash + 1)};
    return named(out.job) && named(out.step) ? std::optional(std::move(out)) : std::nullopt;
}

std::string job_folder(const std::string& work_folder, const std::string& job) {
    return work_folder + "/jobs/" + job;
}

std::string task_name(const std::string& step, const std::optional<FrameSet>& frames) {
    if (!frames || frames->frames().empty()) return step;
    const auto first = frames->frames().front(), last = frames->frames().back();
    return first == last ? fmt::format("{}.{}", step, first)
                         : fmt::format("{}.{}-{}", step, first, last);
}

std::string task_record(const std::string& work_folder, const JobStep& step,
                        const std::optional<FrameSet>& frames) {
    return fmt::format("{}/tasks/{}.json", job_folder(work_folder, step.job),
                       task_name(step.step, frames));
}

}  // namespace fluidcarve
