#pragma once

#include "graph/build_pipeline.h"
#include "graph/types/registry.h"
#include "runtime/run/run.h"
#include "tools/verbs/print.h"

#include <algorithm>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace fluidcarve {

/// Declares the option --work. @param doc  what the help says of it
void declare_work_folder(CLI::App& verb, std::string& folder,
                         const std::string& doc = "The work folder");

/// Arguments of all verbs that take a pipeline.
struct PipelineArguments {
    std::string path;
    std::vector<std::string> settings;
    std::vector<std::string> folders;  ///< of --confine
    bool allow_plugins = false;

    void declare(CLI::App& verb);
    /// The words of a command line that say the same.
    std::vector<std::string> words() const;

    /// Loads the plugins that a document names, adds their types to the registry, and builds the
    /// pipeline.
    Pipeline build(const Document& document, Registry& registry, Problems& problems) const;

    /// Reads and checks the pipeline. Prints problems and returns nothing if there are any.
    std::optional<Pipeline> read_or_complain(Registry& registry) const;
};

/// Arguments of the verbs that run, plan or schedule a pipeline.
struct RunArguments {
    std::string frames;
    std::string only;
    std::string missing;  ///< of `--missing`; empty: a warning
    bool no_cache = false;
    std::string cache_size;
    int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    int in_flight = 0;
    std::string memory;
    std::string task;  ///< JOB/STEP; empty: the run is no task of a farm's job
    std::string progress = "auto";
    RunRequest request;
    const CLI::Option* threads_option = nullptr;
    const CLI::Option* frames_option = nullptr;  ///< tells an empty -f (an unset variable in a
                                                 ///< farm's script), which is an error, from no -f

    void declare(CLI::App& verb);
    /// These arguments as words of a command line, without frames and without the part of the
    /// pipeline to run.
    std::vector<std::string> words() const;
    /// Declares only the arguments about threads, memory, the work folder and printing.
    void declare_limits(CLI::App& verb);

    /// Checks the arguments. Prints a message and returns nothing if one is wrong.
    std::optional<RunRequest> read(const Pipeline& pipeline);
};

}  // namespace fluidcarve
