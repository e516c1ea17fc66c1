#include "tools/verbs/arguments.h"

#include "carve/base/frame_set.h"
#include "formats/file/confinement.h"
#include "formats/file/full_path.h"
#include "graph/provenance.h"
#include "runtime/flow/options.h"
#include "runtime/keep/work_folder.h"
#include "runtime/run/task.h"
#include "runtime/tell/terminal.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <utility>

namespace fluidcarve {
namespace {

/// Parses "8G", "500M", "1.5 GiB" into bytes. Units are powers of 1024.
std::optional<std::uint64_t> parse_size(const std::string& text) {
    char* end = nullptr;
    const double number = std::strtod(text.c_str(), &end);
    std::string unit(end);
    std::erase(unit, ' ');
    static const std::map<std::string, double> units{
        {"", 0},    {"B", 0}, {"K", 1},  {"KB", 1},  {"KiB", 1}, {"M", 2},  {"MB", 2},
        {"MiB", 2}, {"G", 3}, {"GB", 3}, {"GiB", 3}, {"T", 4},   {"TB", 4}, {"TiB", 4}};
    const auto found = units.find(unit);
    if (end == text.c_str() || found == units.end() || !(number > 0)) return std::nullopt;
    const double bytes = number * std::pow(1024.0, found->second);
    constexpr double most = 1e18;
    return bytes <= most ? std::optional(static_cast<std::uint64_t>(bytes)) : std::nullopt;
}

/// A path with a name before its ending: "out/shot.seams.json".
std::string with_name(const std::string& path, const std::string& name) {
    const std::filesystem::path whole(path);
    return (whole.parent_path() / (whole.stem().string() + "." + name + whole.extension().string()))
        .string();
}

/// Options that say which frames, and which nodes.
void declare_target(CLI::App& verb, RunArguments& run) {
    run.frames_option =
        verb.add_option("-f,--frames", run.frames,
                        "Deliver only these frames of the sequence (1001-1010,1020)")
            ->type_name("FRAMES");
    auto* const to = verb.add_option("--to", run.request.target.to,
                                     "Run only this node and the nodes that it needs, or several, "
                                     "with commas; NODE.INPUT of a solver: only extract its data "
                                     "from each frame")
                         ->type_name("NODE");
    auto* const from = verb.add_option("--from", run.request.target.from,
                                       "Deliver only results that depend on this node")
                           ->type_name("NODE");
    verb.add_option("--only", run.only,
                    "Run this node alone; the cached results that it needs must already be in the "
                    "work folder")
        ->type_name("NODE")
        ->excludes(to)
        ->excludes(from);
    verb.add_option("--missing", run.missing,
                    "Whether `frames: auto` fails where numbers are missing between frames, or "
                    "says nothing of it (default: a warning)")
        ->check(CLI::IsMember({"error", "skip"}))
        ->type_name("error|skip");
}

/// Options that name a run's own files.
void declare_records(CLI::App& verb, RunRequest& request) {
    verb.add_option("--report", request.report_path, "Write a report of the run")
        ->type_name("FILE.json");
    verb.add_option(
            "--html", request.html_path,
            "Write a report of the run as a page: pictures, times, seams, the origin of each value")
        ->type_name("FILE.html");
    verb.add_option("--profile", request.profile_path,
                    "Write a trace for chrome://tracing or Perfetto: when each node ran, and on "
                    "which thread")
        ->type_name("FILE.json");
    verb.add_option("--manifest", request.manifest_path,
                    "Compare each input file with its hash in this file before it is read, and add "
                    "the files that it does not list")
        ->type_name("FILE");
}

/// The files of its own that a run writes or reads, by option.
std::array<std::pair<const char*, std::string>, 4> own_files(const RunRequest& request) {
    return {std::pair("--report", request.report_path), std::pair("--html", request.html_path),
            std::pair("--profile", request.profile_path),
            std::pair("--manifest", request.manifest_path)};
}

// The steps of RunArguments::read: each takes arguments over into the request. They return what is
// wrong; empty: nothing.

std::string take_memory(RunArguments& run, const Pipeline&) {
    run.request.options.memory = half_of_memory();
    if (run.memory.empty()) return {};
    const auto size = parse_size(run.memory);
    if (!size) return fmt::format("--memory must be a size such as 8G, not '{}'", run.memory);
    run.request.options.memory = *size;
    return {};
}

std::string take_frames(RunArguments& run, const Pipeline& pipeline) {
    if (!run.frames_option || run.frames_option->count() == 0) return {};
    auto& deliver = run.request.target.frames;
    std::string fault;
    deliver = FrameSet::parse(run.frames, fault);
    if (!deliver) return "-f: " + fault;
    if (const auto note = staggered_note(run.frames); !note.empty() && !run.request.quiet)
        complain("warning: -f: " + note + "\n");
    std::vector<int> outside;
    for (const auto frame : deliver->frames())
        if (!pipeline.frames.contains(frame)) outside.push_back(frame);
    return outside.empty() ? std::string()
                           : fmt::format("-f: {} is not in the sequence {}",
                                         FrameSet(outside).text(), pipeline.frames.text());
}

/// Refuses or warns of missing frames, and shows the other notes on the pipeline.
std::string take_holes(RunArguments& run, const Pipeline& pipeline) {
    if (run.missing == "error" && !pipeline.holes.empty()) return pipeline.holes;
    if (run.request.quiet) return {};
    if (run.missing.empty() && !pipeline.holes.empty())
        complain("warning: " + pipeline.holes + "\n");
    for (const auto& note : pipeline.notes) complain("warning: " + note + "\n");
    return {};
}

std::string take_work_folder(RunArguments& run, const Pipeline&) {
    auto& options = run.request.options;
    options.cache = !run.no_cache;
    const WorkFolder folder(options.work_folder);
    if (const auto refusal = folder.refusal(); !refusal.empty())
        return fmt::format("--work: {} {}", options.work_folder, refusal);
    if (const auto fault = folder.link_fault(); !run.no_cache && !fault.empty())
        return "--work: " + fault;
    if (run.cache_size.empty()) return {};
    const auto size = parse_size(run.cache_size);
    if (!size)
        return fmt::format("--cache-size must be a size such as 50G, not '{}'", run.cache_size);
    options.cache_size = *size;
    // A size says that files may go: only from a folder that is ours.
    const auto fault = folder.fault();
    return fault.empty() ? std::string() : "--cache-size: " + fault;
}

std::string take_nodes(RunArguments& run, const Pipeline& pipeline) {
    auto& target = run.request.target;
    target.only = !run.only.empty();
    if (target.only) target.to = run.only;
    return fault_of(target, pipeline);
}

std::string take_task(RunArguments& run, const Pipeline&) {
    auto& request = run.request;
    if (run.task.empty()) return {};
    request.task = JobStep::parse(run.task);
    if (!request.task)
        return fmt::format("--task {}: must be JOB/STEP, each of letters, digits, - and _",
                           run.task);
    const auto name = task_name(request.task->step, request.target.frames);
    for (auto* const path : {&request.report_path, &request.html_path, &request.profile_path})
        if (!path->empty()) *path = with_name(*path, name);
    return {};
}

std::string take_own_files(RunArguments& run, const Pipeline& pipeline) {
    std::map<std::filesystem::path, const char*> own;
    for (const auto& [option, path] : own_files(run.request)) {
        if (path.empty()) continue;
        if (const auto refusal = Confinement::of_program().refusal(path); !refusal.empty())
            return fmt::format("{}: {} {}", option, path, refusal);
        if (const auto user = user_of(pipeline, path); !user.empty())
            return fmt::format("{} would overwrite {}: {}", option, path, user);
        auto place = canonical_path(path);
        const auto [other, fresh] =
            own.emplace(place.empty() ? std::filesystem::path(path) : std::move(place), option);
        if (!fresh)
            return fmt::format("{} and {} name the same file: {}", other->second, option, path);
    }
    return {};
}

/// What --progress accepts, and its style; no style: a bar in a coloured terminal, else plain.
constexpr std::array<std::pair<const char*, std::optional<ProgressStyle>>, 6> progress_styles{
    {{"auto", std::nullopt},
     {"bar", ProgressStyle::bar},
     {"json", ProgressStyle::json},
     {"plain", ProgressStyle::plain},
     {"openjd", ProgressStyle::openjd},
     {"none", ProgressStyle::none}}};

ProgressStyle style_of(const std::string& progress, bool quiet) {
    if (quiet) return ProgressStyle::none;
    for (const auto& [name, style] : progress_styles)
        if (progress == name && style) return *style;
    return coloured_terminal() ? ProgressStyle::bar : ProgressStyle::plain;
}

}  // namespace

void declare_work_folder(CLI::App& verb, std::string& folder, const std::string& doc) {
    verb.add_option("--work", folder, doc)
        ->capture_default_str()
        ->type_name("DIR")
        ->envname("FLUIDCARVE_WORK");
}

void PipelineArguments::declare(CLI::App& verb) {
    verb.add_option("pipeline", path,
                    "Pipeline file (YAML). Its relative inputs are looked for in the folder of the "
                    "file that states them, then in the current folder; those of --set in the "
                    "current folder. Its outputs go to the current folder")
        ->required()
        ->type_name("PIPELINE");
    verb.add_option("--set", settings,
                    "Override a field of a node, a param, or the frames; may be repeated")
        ->type_name("NODE.FIELD=VALUE|PARAM=VALUE|frames=VALUE")
        ->expected(1)
        ->take_all();
    verb.add_flag("--allow-plugins", allow_plugins,
                  "Load the plugins and run the scripts that the pipeline names; their code runs "
                  "with all your rights");
    verb.add_option("--confine", folders,
                    "Let the pipeline read and write in this folder only; may be repeated, for "
                    "several folders")
        ->type_name("DIR")
        ->expected(1)
        ->take_all();
}

std::vector<std::string> PipelineArguments::words() const {
    std::vector<std::string> out{path};
    for (const auto& setting : settings) out.insert(out.end(), {"--set", setting});
    for (const auto& folder : folders) out.insert(out.end(), {"--confine", folder});
    if (allow_plugins) out.emplace_back("--allow-plugins");
    return out;
}

Pipeline PipelineArguments::build(const Document& document, Registry& registry,
                                  Problems& problems) const {
    PluginFiles files;
    const auto before = problems.size();
    load_plugins(document.plugins, {allow_plugins, trusted_plugin_folders()}, registry, files,
                 problems);
    // Nodes can't be checked without the types of all plugins.
    if (problems.size() > before) return {};
    return build_pipeline(document, registry, problems, std::move(files));
}

std::optional<Pipeline> PipelineArguments::read_or_complain(Registry& registry) const {
    Problems problems;
    const auto document = read_document(path, settings, problems);
    auto pipeline = build(document, registry, problems);
    if (!problems.empty()) return complain(to_text(problems)), std::nullopt;
    state_provenance(pipeline, document, registry);
    return pipeline;
}

void RunArguments::declare(CLI::App& verb) {
    declare_target(verb, *this);
    declare_limits(verb);
    declare_records(verb, request);
    verb.add_option("--wait", request.wait,
                    "Seconds to wait for results of other runs in the work folder, such as a "
                    "farm's earlier steps; fail if they do not come")
        ->check(CLI::NonNegativeNumber)
        ->type_name("SECONDS");
    verb.add_option("--task", task,
                    "Record this run as a task of a farm's job, and put its name into those of "
                    "--report, --html and --profile")
        ->type_name("JOB/STEP");
    verb.add_flag("--sync", request.options.sync,
                  "Wait until each written file is on the disk, so that it is whole or absent "
                  "after a power cut, too");
    verb.add_flag("--keep-going", request.options.keep_going,
                  "Run the other frames when one fails");
}

void RunArguments::declare_limits(CLI::App& verb) {
    threads_option = verb.add_option("--threads", threads, "Threads")
                         ->check(CLI::Range(1, 4096))
                         ->capture_default_str()
                         ->envname("FLUIDCARVE_THREADS");
    verb.add_option("--in-flight", in_flight, "Frames in memory at once (default: threads + 1)")
        ->check(CLI::Range(1, 100000));
    verb.add_option("--memory", memory,
                    "Memory that a node may use for the whole sequence before it uses files, and "
                    "that a grid may take (default: half of the machine's memory)")
        ->type_name("SIZE")
        ->envname("FLUIDCARVE_MEMORY");
    declare_work_folder(
        verb, request.options.work_folder,
        "Folder for temporary files, and for cached results that later runs use again");
    verb.add_flag("--no-cache", no_cache,
                  "Neither read nor write cached results in the work folder")
        ->envname("FLUIDCARVE_NO_CACHE");
    verb.add_option("--cache-size", cache_size,
                    fmt::format("Size of the cached results that remain after a run; the least "
                                "recently used are removed (default: {}G)",
                                RunOptions{}.cache_size >> 30))
        ->type_name("SIZE")
        ->envname("FLUIDCARVE_CACHE_SIZE");
    verb.add_option("--progress", progress, "How to show progress")
        ->check(CLI::IsMember(progress_styles))
        ->capture_default_str();
    const auto quiet = verb.add_flag("-q,--quiet", request.quiet, "Print failures only");
    verb.add_flag("-v,--verbose", request.verbose,
                  "Show the plan, where the files lie, and the time of each node")
        ->excludes(quiet);
}

std::vector<std::string> RunArguments::words() const {
    std::vector<std::string> out{"--work",     request.options.work_folder,
                                 "--threads",  std::to_string(threads),
                                 "--progress", progress};
    if (in_flight > 0) out.insert(out.end(), {"--in-flight", std::to_string(in_flight)});
    const auto add = [&](const char* option, const std::string& value) {
        if (!value.empty()) out.insert(out.end(), {option, value});
    };
    add("--memory", memory);
    add("--missing", missing);
    add("--cache-size", cache_size);
    for (const auto& [option, path] : own_files(request)) add(option, path);
    if (request.wait) out.insert(out.end(), {"--wait", fmt::format("{}", *request.wait)});
    for (const auto& [option, on] :
         {std::pair("--no-cache", no_cache), std::pair("--sync", request.options.sync),
          std::pair("--keep-going", request.options.keep_going),
          std::pair("--quiet", request.quiet), std::pair("--verbose", request.verbose)})
        if (on) out.emplace_back(option);
    return out;
}

std::optional<RunRequest> RunArguments::read(const Pipeline& pipeline) {
    request.options.threads = threads;
    request.options.in_flight = in_flight > 0 ? in_flight : threads + 1;
    for (const auto take : {&take_memory, &take_frames, &take_holes, &take_work_folder, &take_nodes,
                            &take_task, &take_own_files})
        if (const auto fault = take(*this, pipeline); !fault.empty())
            return complain(fault + "\n"), std::nullopt;
    request.progress = style_of(progress, request.quiet);
    return request;
}

}  // namespace fluidcarve
