#pragma once

#include "carve/base/frame_set.h"

#include <optional>
#include <string>

namespace fluidcarve {

/// A step of a farm's job, as --task names it.
struct JobStep {
    std::string job, step;  ///< each of letters, digits, - and _

    /// @param text  JOB/STEP
    /// @return nothing if the text is of another form
    static std::optional<JobStep> parse(const std::string& text);
    std::string text() const { return job + "/" + step; }
};

/// The folder of a farm's job in a work folder.
std::string job_folder(const std::string& work_folder, const std::string& job);
/// The status file of a task of a farm's job.
/// @param frames  of the task; nothing: its step has one task
std::string task_record(const std::string& work_folder, const JobStep& step,
                        const std::optional<FrameSet>& frames);
/// The name of a task: `seams-energy.1001-1010`, by its first and last frame.
std::string task_name(const std::string& step, const std::optional<FrameSet>& frames);

}  // namespace fluidcarve
