#include "tools/verbs/verbs.h"

#include "carve/base/words.h"
#include "formats/file/full_path.h"
#include "graph/provenance.h"
#include "graph/text/shell_word.h"
#include "runtime/jobs/engine.h"
#include "runtime/jobs/engines.h"
#include "runtime/jobs/job_status.h"
#include "runtime/jobs/plan_farm.h"
#include "runtime/run/interrupt.h"
#include "runtime/tell/terminal.h"
#include "runtime/tell/uncaught.h"
#include "tools/verbs/arguments.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <linux/magic.h>
#include <sys/vfs.h>
#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace fluidcarve {
namespace {

/// Arguments of the verb `farm`, besides those of `run`.
struct FarmArguments {
    std::string engine;
    std::size_t chunk = 0;
    double minutes = 0;
    std::string prefix;
    bool dry_run = false;
    bool json = false;
    bool no_chunk_extension = false;
    FarmRequest request;
    const CLI::Option* chunk_option = nullptr;
    const CLI::Option* minutes_option = nullptr;
    std::vector<const CLI::Option*> engine_options;  ///< those that only some engines take

    void declare(CLI::App& verb, PipelineArguments& pipeline, RunArguments& run);
};

namespace fs = std::filesystem;

constexpr int grace_ms = 5000;       ///< for tasks to end after a signal
constexpr double wait_seconds = 60;  ///< of tasks, for results of others; NFS shows files late by
                                     ///< up to 60 s unless it is set otherwise

/// The program that tasks run.
/// @param called  the first word of the command; the path, if the archive's launcher started the
///   program by a loader
std::string executable_of(const FarmArguments& arguments, const fs::path& called) {
    if (const auto* const named = std::getenv("FLUIDCARVE_EXECUTABLE"); named && *named)
        return named;
    if (!arguments.prefix.empty()) return "fluidcarve";
    std::error_code error;
    auto own = called.is_absolute() ? fs::canonical(called, error) : fs::path();
    if (own.empty()) own = fs::read_symlink("/proc/self/exe", error);
    return own.empty() ? "fluidcarve" : own.string();
}

/// The variables that tasks need, as other machines may have another environment: those that the
/// pipeline takes values from, and the one that trusts its plugins.
std::vector<std::pair<std::string, std::string>> environment_of(const Document& document,
                                                                const Pipeline& pipeline) {
    auto out = document.environment;
    const auto* const trusted = std::getenv("FLUIDCARVE_PLUGINS");
    if (!pipeline.plugins.empty() && trusted) out.emplace_back("FLUIDCARVE_PLUGINS", trusted);
    return out;
}

/// The names of the engines that take an option; of all, if it is empty.
std::vector<std::string> engines_with(const std::string& option) {
    std::vector<std::string> out;
    for (const auto& engine : farm_engines())
        if (option.empty() || std::ranges::find(engine.options, option) != engine.options.end())
            out.push_back(engine.name);
    return out;
}

/// What is wrong with the arguments; empty: nothing.
std::string fault_of(const FarmArguments& arguments, const RunArguments& run) {
    const auto* const engine = find_engine(arguments.engine);
    if (!engine)
        return fmt::format("there is no farm engine '{}'{}", arguments.engine,
                           did_you_mean(arguments.engine, engines_with({})));
    for (const auto* const option : arguments.engine_options)
        if (option->count() > 0 &&
            std::ranges::find(engine->options, option->get_name()) == engine->options.end())
            return fmt::format("{}: {} does not take it; it is for {}", option->get_name(),
                               engine->name, fmt::join(engines_with(option->get_name()), " and "));
    if (arguments.chunk_option->count() > 0 && arguments.chunk == 0)
        return "--chunk 0: a task takes at least 1 frame";
    if (arguments.minutes_option->count() > 0 && !(arguments.minutes > 0))
        return fmt::format("--minutes {}: a task takes more than 0 minutes", arguments.minutes);
    if (run.no_cache)
        return "--no-cache: the steps of a farm hand on their results in the work folder; leave it "
               "out";
    if (!run.only.empty())
        return fmt::format("--only {0}: a farm makes all that is missing; name --to {0}", run.only);
    return engine->refusal ? engine->refusal(arguments.request) : std::string();
}

/// The file systems of memory and of disks in a machine (statfs).
constexpr std::array<long, 2> memories{TMPFS_MAGIC, RAMFS_MAGIC};
constexpr std::array<long, 5> disks{EXT4_SUPER_MAGIC, XFS_SUPER_MAGIC, BTRFS_SUPER_MAGIC,
                                    OVERLAYFS_SUPER_MAGIC, F2FS_SUPER_MAGIC};

/// Whether a folder, which need not exist, lies in one of the file systems.
bool lies_in(const std::string& folder, std::span<const long> file_systems) {
    auto there = fs::path(folder);
    std::error_code error;
    while (!fs::exists(there, error) && there.has_parent_path() && there != there.parent_path())
        there = there.parent_path();
    struct statfs about {};
    return statfs(there.c_str(), &about) == 0 &&
           std::ranges::find(file_systems, static_cast<long>(about.f_type)) != file_systems.end();
}

/// Fills in options that a task states and the command line does not.
void fill_in(RunArguments& run, const FarmEngine& engine, int processes) {
    if (run.threads_option->count() == 0 && !engine.other_machines)
        run.threads = std::max(1, run.threads / processes);
    if (run.progress == "auto") run.progress = engine.progress;
    run.request.wait = run.request.wait.value_or(wait_seconds);
}

/// Makes the path of the work folder absolute, and warns if other machines may not see it.
/// @return why they can't; empty: they can, or need not
std::string place_work_folder(RunRequest& request, const FarmEngine& engine) {
    auto& work = request.options.work_folder;
    work = full_path(work).string();
    if (!engine.other_machines) return {};
    if (lies_in(work, memories))
        return fmt::format(
            "--work: {} is in the memory of this machine, and other machines can't "
            "see it; name a shared folder",
            work);
    if (lies_in(work, disks) && !request.quiet)
        tell(
            fmt::format("warning: --work: {} is on a disk of this machine; tasks fail on machines "
                        "that do not see it at this path",
                        work));
    return {};
}

FarmChunking chunking_of(const FarmArguments& arguments, const FarmEngine& engine) {
    FarmChunking out;
    if (arguments.chunk > 0) out.frames = arguments.chunk;
    else if (arguments.minutes > 0) out.minutes = arguments.minutes;
    else if (!engine.other_machines)
        out.tasks = static_cast<std::size_t>(arguments.request.processes);
    return out;
}

/// Shows a job, or hands it to an engine. @return an exit code
int hand_over(const FarmJob& job, const FarmEngine& engine, const FarmArguments& arguments,
              bool quiet, const Interrupt& interrupt) {
    if (arguments.dry_run)
        return arguments.json ? print_json(to_json(job)) : print(to_text(job)), exit_code::done;
    record_job(job, engine.name);
    auto asked = arguments.request;
    asked.chunk_ranges = !arguments.no_chunk_extension;
    asked.quiet = quiet;
    asked.cancelled = [&] { return interrupt.asked(); };
    return engine.farm(job, asked);
}

void FarmArguments::declare(CLI::App& verb, PipelineArguments& pipeline, RunArguments& run) {
    std::string engines;
    for (const auto& each : farm_engines())
        engines += fmt::format("{}{} {}", engines.empty() ? "" : "; ", each.name, each.doc);
    verb.add_option("engine", engine, "What runs the steps: " + engines)
        ->required()
        ->type_name("ENGINE");
    pipeline.declare(verb);
    run.declare(verb);
    chunk_option = verb.add_option("--chunk", chunk,
                                   "Frames of a task (default: as many as take ten minutes, by "
                                   "earlier runs; 10 if nothing was measured)");
    minutes_option =
        verb.add_option("--minutes", minutes, "Minutes that a task should take, by earlier runs")
            ->excludes("--chunk");
    auto* const processes = verb.add_option("-j,--processes", request.processes,
                                            "Of `local`: tasks at once; they share the threads")
                                ->check(CLI::Range(1, 4096))
                                ->capture_default_str();
    verb.add_option(
            "--prefix", prefix,
            "Words before the program in each task's command, such as 'rez-env fluidcarve --'")
        ->type_name("WORDS");
    auto* const output = verb.add_option("--output", request.output,
                                         "Of `slurm` and `openjd`: folder that they write "
                                         "(default: one of the job's name in the current folder)")
                             ->type_name("DIR");
    auto* const submit =
        verb.add_flag("--submit", request.submit, "Of `slurm`: hand the job over, too");
    verb.add_flag("--dry-run", dry_run, "Only show the steps and their commands; make nothing");
    verb.add_flag("--json", json, "With --dry-run: print as JSON");
    auto* const no_extension = verb.add_flag(
        "--no-chunk-extension", no_chunk_extension,
        "Of `openjd`: pairs of first and last frame in place of the extension TASK_CHUNKING");
    engine_options = {processes, output, submit, no_extension};
}

/// The verb `farm`: makes a job of a run and hands it to an engine.
/// @param command  the words of the command line
/// @return an exit code
int farm(const FarmArguments& arguments, const PipelineArguments& pipeline_arguments,
         RunArguments& run, const std::vector<std::string>& command, Registry& registry) {
    if (const auto fault = fault_of(arguments, run); !fault.empty()) return end_with(fault);
    const auto& engine = *find_engine(arguments.engine);
    Problems problems;
    const auto document =
        read_document(pipeline_arguments.path, pipeline_arguments.settings, problems);
    auto pipeline = pipeline_arguments.build(document, registry, problems);
    if (!problems.empty()) return end_with(problems);
    state_provenance(pipeline, document, registry);
    const Interrupt interrupt(std::string(), grace_ms);
    fill_in(run, engine, arguments.request.processes);
    auto request = run.read(pipeline);
    if (!request) return exit_code::usage;
    if (const auto fault = place_work_folder(*request, engine); !fault.empty())
        return end_with(fault);
    run.request.options.work_folder = request->options.work_folder;
    FarmCommand shared{environment_of(document, pipeline),
                       CLI::detail::split_up(arguments.prefix),
                       executable_of(arguments, command.front()),
                       {"run"},
                       run.words(),
                       {}};
    for (auto& word : pipeline_arguments.words()) shared.pipeline.push_back(std::move(word));
    shared.again =
        fmt::format("cd {} && {}", shell_word(fs::current_path().string()), shell_line(command));
    try {
        require_threads(request->options.threads);
        const auto job =
            plan_farm(pipeline, registry, *request, chunking_of(arguments, engine), shared);
        return job ? hand_over(*job, engine, arguments, request->quiet, interrupt)
                   : exit_code::input;
    } catch (const Failure& failure) {
        return tell(fmt::format("failed: {}", failure.what())), exit_code::of(failure);
    }
}

}  // namespace

Verb::Work farm_verb(CLI::App& verb, Program& program) {
    const auto farm_arguments = std::make_shared<FarmArguments>();
    const auto run_arguments = std::make_shared<RunArguments>();
    farm_arguments->declare(verb, program.pipeline, *run_arguments);
    return [=, &program] {
        return farm(*farm_arguments, program.pipeline, *run_arguments, program.words,
                    program.registry);
    };
}

}  // namespace fluidcarve
