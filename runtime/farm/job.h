#pragma once

#include "graph/pipeline.h"
#include "graph/types/frames.h"
#include "graph/types/registry.h"
#include "runtime/run/run.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// What a task asks of its machine. 0: not known.
struct FarmResources {
    int cores = 0;
    std::uint64_t memory = 0;  ///< bytes
    std::uint64_t disk = 0;    ///< bytes that it writes, in the work folder and as outputs
    double seconds = 0;
};

/// One process of a step.
struct FarmTask {
    FrameSet frames;  ///< for -f; empty: the step has one task, without -f
};

/// A part of a run that waits for other parts: the frames of one gathering node, its result, or what a node delivers.
struct FarmStep {
    std::string name;                    ///< unique in the job; letters, digits, `-` and `_`
    std::string what;                    ///< what it does, as a plain clause: "digests frames for seams"
    std::vector<std::string> needs;      ///< names of the steps that must have ended well
    std::vector<std::string> arguments;  ///< words after `fluidcarve`, from `run` on, without -f
    bool chunked = false;                ///< its tasks have frames of their own, each frame in one task
    std::vector<FarmTask> tasks;         ///< at least one
    FarmResources resources;             ///< of its largest task
};

/// A file, sequence or folder that the pipeline reads or writes.
struct FarmPath {
    std::string name;     ///< unique in the job: node and field, `sim.path`
    std::string path;     ///< absolute; of a sequence its folder
    std::string file;     ///< of a sequence: its name in the folder, with its frame token
    bool folder = false;  ///< a folder, and not one file
    bool in = false;      ///< the pipeline reads it
    bool out = false;     ///< the pipeline writes it
};

/// A run as steps for a farm. It begins in `folder`, on every machine.
struct FarmJob {
    std::string name;                 ///< of the pipeline file, without its ending
    std::string pipeline;             ///< path of the pipeline file, as it was given
    std::string folder;               ///< the current folder, absolute
    std::vector<std::string> prefix;  ///< words before the program: `rez-env fluidcarve --`
    std::string executable;           ///< the program
    std::string work;                 ///< the work folder, absolute
    std::vector<FarmStep> steps;      ///< a step stands after those that it needs
    std::vector<FarmPath> paths;      ///< all that the pipeline reads and writes

    const FarmStep* find(const std::string& step) const;
};

/// How many frames a task takes. At most one of both is set; none: tasks of about ten minutes, or of ten frames where no run was measured.
struct FarmChunking {
    std::optional<std::size_t> frames;
    std::optional<double> minutes;
};

/// The words of a task's command: prefix, program, arguments and -f. Frames are joined to their option, so that negative ones are no option.
std::vector<std::string> command_of(const FarmJob& job, const FarmStep& step, const FarmTask& task);

/// Words as one line for a POSIX shell, quoted where needed.
std::string shell_line(const std::vector<std::string>& words);

/// Splits the frames into runs of at most `most`, in order, so that each frame is in one.
std::vector<FarmTask> chunks_of(const FrameSet& frames, std::size_t most);

}  // namespace fluidcarve
