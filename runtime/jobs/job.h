#pragma once

#include "carve/base/frame_set.h"
#include "runtime/run/run_resources.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// A part of a run that waits for other parts (RunStep).
struct FarmStep {
    std::string name;                    ///< unique in the job; letters, digits, `-` and `_`
    std::string what;                    ///< what it does, as a clause
    std::vector<std::string> needs;      ///< names of the steps that must have succeeded
    std::vector<std::string> arguments;  ///< words after `fluidcarve`, from `run` on, without -f
    bool chunked = false;  ///< its tasks have frames of their own, each frame in one task
    /// The frames of each task, for -f; a task is one process. If the step is not chunked: one
    /// task, without frames and without -f.
    std::vector<FrameSet> tasks;
    RunResources resources;  ///< of its largest task
};

/// A file, sequence or folder that the pipeline reads or writes.
struct FarmPath {
    std::string name;  ///< unique in the job: node and field, `sim.path`; `pipeline`, `pipeline 2`
                       ///< and so on, and `work`
    std::string path;  ///< absolute; of a sequence its folder
    std::string file;  ///< of a sequence: its name in the folder, with its frame token
    bool folder = false;  ///< a folder, and not one file
    bool in = false;      ///< it is read
    bool out = false;     ///< it is written
};

/// A run divided into steps for a farm. Its tasks start in `folder`, on every machine.
struct FarmJob {
    std::string name;      ///< unique in the work folder; the same command makes the same name
    std::string pipeline;  ///< path of the pipeline file, as it was given
    std::string folder;    ///< the current folder, absolute
    /// Words before the program: `env SHOT=sh010 rez-env fluidcarve --`
    std::vector<std::string> prefix;
    std::string executable;       ///< the program
    std::string work;             ///< the work folder, absolute
    std::string again;            ///< the shell command that makes this job again
    std::vector<FarmStep> steps;  ///< a step stands after those that it needs
    std::vector<FarmPath> paths;  ///< all files and folders read and written

    /// The step of a name; null: there is none.
    const FarmStep* find(const std::string& step) const;
    std::size_t tasks() const;  ///< of all steps
};

/// How many frames a task takes. At most one is set; none: tasks of about ten minutes, or of ten
/// frames where nothing was measured.
struct FarmChunking {
    std::optional<std::size_t> frames;  ///< of each task
    std::optional<double> minutes;      ///< wall time of each task, estimated from earlier runs
    std::optional<std::size_t> tasks;   ///< of each step
};

/// The words of a task's command: prefix, program, arguments and frames. Frames are joined to
/// their option (`--frames=`), since they may be negative.
/// @param task  its frames
std::vector<std::string> command_of(const FarmJob& job, const FarmStep& step, const FrameSet& task);

/// Splits frames into tasks of at most `most`, in order, each frame in one.
std::vector<FrameSet> chunks_of(const FrameSet& frames, std::size_t most);

/// The job for people: its steps, what each waits for, its tasks and their resources, and the
/// command of its first task.
std::string to_text(const FarmJob& job);
/// The job for programs, as pipelines/FORMATS.md says.
nlohmann::ordered_json to_json(const FarmJob& job);

}  // namespace fluidcarve
