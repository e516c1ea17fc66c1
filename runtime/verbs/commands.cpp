#include "runtime/verbs/commands.h"
#include "runtime/keep/work_folder.h"

#include "graph/build_pipeline.h"
#include "graph/confinement.h"
#include "graph/text/words.h"
#include "graph/views/describe.h"
#include "graph/views/drawing.h"
#include "graph/views/file_places.h"
#include "graph/views/origins.h"
#include "graph/views/provenance.h"
#include "graph/views/schema.h"
#include "runtime/run/interrupt.h"
#include "runtime/run/run.h"
#include "runtime/run/status.h"
#include "runtime/tell/outcome.h"
#include "runtime/tell/terminal.h"
#include "runtime/verbs/diff.h"
#include "runtime/verbs/explain.h"
#include "runtime/verbs/inspect.h"
#include "runtime/verbs/new_node.h"
#include "runtime/verbs/shell.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <unistd.h>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <thread>

namespace fluidcarve {
namespace {

void print(const std::string& text) { std::fwrite(text.data(), 1, text.size(), stdout); }
void complain(const std::string& text) { std::fwrite(text.data(), 1, text.size(), stderr); }

/// Parses "8G", "500M", "1.5 GiB" into bytes. Units are powers of 1024.
std::optional<std::uint64_t> parse_size(const std::string& text) {
    char* end = nullptr;
    const double number = std::strtod(text.c_str(), &end);
    std::string unit(end);
    std::erase(unit, ' ');
    static const std::map<std::string, double> units{{"", 0},    {"B", 0}, {"K", 1},  {"KB", 1},  {"KiB", 1}, {"M", 2},  {"MB", 2},
                                                     {"MiB", 2}, {"G", 3}, {"GB", 3}, {"GiB", 3}, {"T", 4},   {"TB", 4}, {"TiB", 4}};
    const auto found = units.find(unit);
    if (end == text.c_str() || found == units.end() || !(number > 0) || number > 1e15) return std::nullopt;
    return static_cast<std::uint64_t>(number * std::pow(1024.0, found->second));
}

std::uint64_t half_of_memory() { return static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) / 2; }

/// Arguments of all verbs that take a pipeline.
struct PipelineArguments {
    std::string path;
    std::vector<std::string> settings;
    std::vector<std::string> folders;  ///< of --confine
    bool allow_plugins = false;

    void declare(CLI::App& verb) {
        verb.add_option("pipeline", path,
                        "Pipeline file (YAML). Its relative inputs are looked for in the folder of the file that states them, then in the current folder; "
                        "those of --set in the current folder. Its outputs go to the current folder")
            ->required()
            ->type_name("PIPELINE");
        verb.add_option("--set", settings, "Override a field of a node, a param, or the frames; may be repeated")
            ->type_name("NODE.FIELD=VALUE|PARAM=VALUE|frames=VALUE")
            ->expected(1)
            ->take_all();
        verb.add_flag("--allow-plugins", allow_plugins, "Load the plugins that the pipeline names; their code runs with all your rights");
        verb.add_option("--confine", folders, "Let the pipeline read and write in this folder only; may be repeated, for several folders")
            ->type_name("DIR")
            ->expected(1)
            ->take_all();
    }

    /// Loads the plugins that a document names, adds their types to the registry, and builds the pipeline.
    Pipeline build(const Document& document, Registry& registry, Problems& problems) const {
        PluginFiles files;
        const auto before = problems.size();
        load_plugins(document.plugins, {allow_plugins, trusted_plugin_folders()}, registry, files, problems);
        // Nodes can't be checked without the types of all plugins.
        if (problems.size() > before) return {};
        auto pipeline = build_pipeline(document, registry, problems);
        pipeline.plugins = std::move(files);
        return pipeline;
    }

    /// Reads and checks the pipeline. Prints problems and returns nothing if there are any.
    std::optional<Pipeline> read_or_complain(Registry& registry) const {
        Problems problems;
        const auto document = read_document(path, settings, problems);
        auto pipeline = build(document, registry, problems);
        complain(to_text(problems));
        if (!problems.empty()) return std::nullopt;
        state_provenance(pipeline, document, registry);
        return pipeline;
    }
};

/// Arguments of the verbs `run` and `plan`.
struct RunArguments {
    std::string frames;
    std::string only;
    bool no_cache = false;
    std::string cache_size;
    int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    int in_flight = 0;
    std::string memory;
    std::string progress = "auto";
    RunRequest request;
    const CLI::Option* frames_option = nullptr;  ///< tells an empty -f (an unset variable in a farm's script), which is an error, from no -f

    void declare(CLI::App& verb) {
        frames_option = verb.add_option("-f,--frames", frames, "Deliver only these frames of the sequence (1001-1010,1020)")->type_name("FRAMES");
        auto* const to = verb.add_option("--to", request.wish.to,
                                         "Run only this node and the nodes that it needs; NODE.INPUT of a solver: only extract its data from each frame")
                             ->type_name("NODE");
        auto* const from = verb.add_option("--from", request.wish.from, "Deliver only results that depend on this node")->type_name("NODE");
        verb.add_option("--only", only, "Run this node alone; the cached results that it needs must already be in the work folder")
            ->type_name("NODE")
            ->excludes(to)
            ->excludes(from);
        verb.add_option("--threads", threads, "Threads")->check(CLI::Range(1, 4096))->capture_default_str()->envname("FLUIDCARVE_THREADS");
        verb.add_option("--in-flight", in_flight, "Frames in memory at once (default: threads + 1)")->check(CLI::Range(1, 100000));
        verb.add_option(
                "--memory", memory,
                "Memory that a node may use for the whole sequence before it uses files, and that a grid may take (default: half of the machine's memory)")
            ->type_name("SIZE")
            ->envname("FLUIDCARVE_MEMORY");
        verb.add_option("--work", request.options.work_folder, "Folder for temporary files, and for cached results that later runs use again")
            ->capture_default_str()
            ->type_name("DIR")
            ->envname("FLUIDCARVE_WORK");
        verb.add_flag("--no-cache", no_cache, "Neither read nor write cached results in the work folder")->envname("FLUIDCARVE_NO_CACHE");
        verb.add_option("--cache-size", cache_size, "Size of the cached results that remain after a run; the least recently used are removed (default: 50G)")
            ->type_name("SIZE")
            ->envname("FLUIDCARVE_CACHE_SIZE");
        verb.add_option("--report", request.report_path, "Write a report of the run")->type_name("FILE.json");
        verb.add_option("--html", request.html_path, "Write a report of the run as a page: pictures, times, seams, the origin of each value")
            ->type_name("FILE.html");
        verb.add_option("--profile", request.profile_path, "Write a trace for chrome://tracing or Perfetto: when each node ran, and on which thread")
            ->type_name("FILE.json");
        verb.add_option("--manifest", request.manifest_path,
                        "Compare each input file with its hash in this file before it is read, and add the files that it does not list")
            ->type_name("FILE");
        verb.add_option("--progress", progress, "How to show progress")->check(CLI::IsMember({"auto", "bar", "json", "none"}))->capture_default_str();
        verb.add_flag("--sync", request.options.sync, "Wait until each written file is on the disk, so that it is whole or absent after a power cut, too");
        verb.add_flag("--keep-going", request.options.keep_going, "Run the other frames when one fails");
        const auto quiet = verb.add_flag("-q,--quiet", request.quiet, "Print failures only");
        verb.add_flag("-v,--verbose", request.verbose, "Show the plan, where the files lie, and the time of each node")->excludes(quiet);
    }

    /// Checks the arguments. Prints a message and returns nothing if one is wrong.
    std::optional<RunRequest> read(const Pipeline& pipeline) {
        const auto wrong = [](const std::string& message) {
            complain(message + "\n");
            return std::nullopt;
        };
        request.options.threads = threads;
        request.options.in_flight = in_flight > 0 ? in_flight : threads + 1;
        request.options.memory = half_of_memory();
        if (!memory.empty()) {
            const auto size = parse_size(memory);
            if (!size) return wrong(fmt::format("--memory wants a size such as 8G, not '{}'", memory));
            request.options.memory = *size;
        }
        if (frames_option->count() > 0) {
            std::string fault;
            request.deliver = FrameSet::parse(frames, fault);
            if (!request.deliver) return wrong("-f: " + fault);
            std::vector<int> outside;
            for (const auto frame : request.deliver->frames())
                if (!pipeline.frames.contains(frame)) outside.push_back(frame);
            if (!outside.empty()) return wrong(fmt::format("-f: {} is not in the sequence {}", FrameSet(outside).text(), pipeline.frames.text()));
        }
        request.options.cache = !no_cache;
        if (const auto refusal = WorkFolder(request.options.work_folder).refusal(); !refusal.empty())
            return wrong(fmt::format("--work: {} {}", request.options.work_folder, refusal));
        if (!cache_size.empty()) {
            const auto size = parse_size(cache_size);
            if (!size) return wrong(fmt::format("--cache-size wants a size such as 50G, not '{}'", cache_size));
            request.options.cache_size = *size;
            // A size says that files may go: only from a folder that is ours.
            if (const auto fault = WorkFolder(request.options.work_folder).fault(); !fault.empty()) return wrong("--cache-size: " + fault);
        }
        request.wish.only = !only.empty();
        if (request.wish.only) request.wish.to = only;
        if (const auto fault = fault_of(request.wish, pipeline); !fault.empty()) return wrong(fault);
        std::map<std::filesystem::path, const char*> own;
        for (const auto& [option, path] : {std::pair("--report", request.report_path), std::pair("--html", request.html_path),
                                           std::pair("--profile", request.profile_path), std::pair("--manifest", request.manifest_path)}) {
            if (path.empty()) continue;
            if (const auto refusal = Confinement::of_program().refusal(path); !refusal.empty()) return wrong(fmt::format("{}: {} {}", option, path, refusal));
            if (const auto user = user_of(pipeline, path); !user.empty()) return wrong(fmt::format("{} would overwrite {}: {}", option, path, user));
            std::error_code unknown;  // what a descriptor leads to may have no path
            auto place = std::filesystem::weakly_canonical(std::filesystem::absolute(path), unknown);
            const auto [other, fresh] = own.emplace(unknown ? std::filesystem::path(path) : std::move(place), option);
            if (!fresh) return wrong(fmt::format("{} and {} name the same file: {}", other->second, option, path));
        }
        const bool terminal = coloured_terminal();
        request.progress = progress == "none" || request.quiet                     ? ProgressStyle::none
                           : progress == "bar" || (progress == "auto" && terminal) ? ProgressStyle::bar
                                                                                   : ProgressStyle::json;
        return request;
    }
};

/// Arguments of the verb `diff`.
struct DiffArguments {
    std::string frames;
    DiffRequest request;
    const CLI::Option* frames_option = nullptr;

    void declare(CLI::App& verb) {
        request.threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
        const auto number = [&](const char* name, double& value, const char* doc) { verb.add_option(name, value, doc)->check(CLI::NonNegativeNumber); };
        for (const auto& [name, path] : {std::pair("a", &request.a), std::pair("b", &request.b)})
            verb.add_option(name, *path, "A file, a sequence such as smoke.####.vdb, or a folder")->required()->type_name(name[0] == 'a' ? "A" : "B");
        frames_option = verb.add_option("-f,--frames", frames, "Compare only these frames (default: all that are there)")->type_name("FRAMES");
        number("--fail", request.tolerance.absolute, "The difference of two values that still passes (default: 0)");
        number("--relative", request.tolerance.relative, "The same, as a share of the greater value; the greater of both allowances counts (default: 0)");
        number("--fail-percent", request.fail_percent, "The percentage of a grid's voxels in a frame that may differ by more (default: 0)");
        number("--warn", request.tolerance.warn, "Count the values that differ by more than this, at most --fail, and warn of them");
        verb.add_option("--picture", request.picture, "Draw slices of A, B and their difference through the voxel that differs most")->type_name("FILE.png");
        verb.add_option("--threads", request.threads, "Threads, and frames compared at once (default: all cores)")
            ->check(CLI::Range(1, 4096))
            ->envname("FLUIDCARVE_THREADS");
    }

    DiffRequest read(bool json) {
        if (frames_option->count() > 0) request.frames = frames;
        request.json = json;
        request.memory = half_of_memory();
        return request;
    }
};

int run(const PipelineArguments& arguments, RunArguments& run_arguments, Registry& registry) {
    Problems problems;
    const auto document = read_document(arguments.path, arguments.settings, problems);
    auto pipeline = arguments.build(document, registry, problems);
    if (!problems.empty()) return complain(to_text(problems)), exit_code::usage;
    state_provenance(pipeline, document, registry);
    auto request = run_arguments.read(pipeline);
    if (!request) return exit_code::usage;
    request->origins = origins_of(document, registry);
    const Interrupt interrupt(request->quiet ? std::string() : interrupted_text(request->options.cache));
    return run_pipeline(pipeline, registry, *request, [&] { return interrupt.asked(); });
}

int check(const PipelineArguments& arguments, bool json, bool verbose, Registry& registry) {
    Problems problems;
    const auto document = read_document(arguments.path, arguments.settings, problems);
    const auto pipeline = arguments.build(document, registry, problems);
    if (!problems.empty()) return json ? print(to_json(problems)) : complain(to_text(problems)), exit_code::usage;
    const auto values = [&] {
        auto out = origins_of(document, registry);
        out.files = file_places(pipeline);
        return out;
    };
    const auto warnings = warnings_of(pipeline);
    if (json) return print(verbose ? to_json(values()) : to_json(warnings)), exit_code::done;
    complain(to_text(warnings));
    print(fmt::format("{}: good; {}, {}\n", arguments.path, counted(pipeline.nodes.size(), "node"), counted(pipeline.frames.frames().size(), "frame")));
    if (verbose) print("\n" + to_text(values()));
    return exit_code::done;
}

int plan(const PipelineArguments& arguments, RunArguments& run_arguments, bool json, Registry& registry) {
    const auto pipeline = arguments.read_or_complain(registry);
    if (!pipeline) return exit_code::usage;
    const auto request = run_arguments.read(*pipeline);
    return request ? plan_pipeline(*pipeline, registry, *request, json) : exit_code::usage;
}

/// Removes all files of fluidcarve from a work folder, and the folder if it is then empty.
int clean(const std::string& path) {
    const WorkFolder folder(path);
    if (const auto fault = folder.fault(); !fault.empty()) return complain(fmt::format("cannot clean: {}\n", fault)), exit_code::usage;
    try {
        const auto [removed, left] = folder.clean();
        const auto others = left == 0 ? std::string() : fmt::format("; {} {} that fluidcarve did not write", left, left == 1 ? "file stays" : "files stay");
        print(removed == 0 && left == 0 ? fmt::format("{}: nothing to clean\n", path) : fmt::format("{}: clean{}\n", path, others));
    } catch (const Failure& failure) {
        return complain(fmt::format("{}\n", failure.what())), exit_code::node_failed;
    }
    return exit_code::done;
}

/// Loads plugins. Prints a message and returns false if one can't be loaded.
bool load_or_complain(const std::vector<std::string>& plugins, Registry& registry) {
    PluginFiles files;
    try {
        for (const auto& file : plugins) load_plugin(file, registry, files);
    } catch (const Failure& failure) {
        return complain(std::string(failure.what()) + "\n"), false;
    }
    return true;
}

/// The message about a name that is neither a node type nor a family, with those near to it.
std::string no_node_type(const std::string& name, const Registry& registry) {
    const auto names = registry.node_names();
    if (name.find('.') != std::string::npos) return fmt::format("there is no node type '{}'{}\n", name, did_you_mean(name, names));
    std::vector<std::string> quoted;
    for (const auto& each : names)
        if (each.ends_with("." + name)) quoted.push_back("'" + each + "'");
    return fmt::format("there is no node type or family '{}'{}\n", name,
                       quoted.empty() ? did_you_mean(name, registry.families()) : fmt::format("; did you mean {}?", either(quoted)));
}

int nodes(const std::string& type, bool json, bool markdown, const Registry& registry) {
    const auto families = registry.families();
    if (std::find(families.begin(), families.end(), type) != families.end()) {
        print(json ? family_to_json(registry, type) : markdown ? family_to_markdown(registry, type) : listing(registry, type));
    } else if (!type.empty()) {
        const auto* const found = registry.node(type);
        if (!found) return complain(no_node_type(type, registry)), exit_code::usage;
        print(json ? to_json(registry, *found) : markdown ? to_markdown(registry, *found) : describe(registry, *found));
    } else {
        print(json ? to_json(registry) : markdown ? to_markdown(registry) : listing(registry));
    }
    return exit_code::done;
}

int graph(const PipelineArguments& arguments, const std::string& format, Registry& registry) {
    const auto pipeline = arguments.read_or_complain(registry);
    if (!pipeline) return exit_code::usage;
    print(format == "svg" ? to_svg(*pipeline, registry) : to_dot(*pipeline, registry));
    return exit_code::done;
}

/// Adds examples to the help of each verb and the manual page.
void add_examples(CLI::App& app) {
    const std::map<std::string, const char*> examples{
        {"run",
         "  fluidcarve run pipelines/plume.yaml --set count=-20\n"
         "  fluidcarve run shot.yaml -f 1001-1010 --report out/shot.json     a farm's chunk\n"
         "  fluidcarve run shot.yaml --manifest shot.manifest                no input may have rotted since the first run\n"
         "  fluidcarve run shot.yaml --to seams.energy -f 1-42              only the solver's data of these frames\n"
         "  fluidcarve run theirs.yaml --confine /shots/sh010 --work /shots/sh010/work\n"
         "  fluidcarve run shot.yaml --only seams                           the solver alone, from cached results"},
        {"check",
         "  fluidcarve check shot.yaml\n  fluidcarve check theirs.yaml --confine /shots/sh010\n  fluidcarve check shot.yaml -v        where each value comes "
         "from, and where the files lie"},
        {"plan", "  fluidcarve plan shot.yaml --set look.weights='[0.4, 0.6]'"},
        {"status", "  fluidcarve status --work /shared/sh010/work"},
        {"clean", "  fluidcarve clean --work /shared/sh010/work"},
        {"nodes",
         "  fluidcarve nodes\n  fluidcarve nodes mask\n  fluidcarve nodes seam.pyramid\n  fluidcarve nodes acme.sparkle --plugin build/acme_sparkle.so"},
        {"new-node", "  fluidcarve new-node acme.sparkle\n  fluidcarve new-node acme.straight --solver --folder /shows/ab/straight"},
        {"schema",
         "  fluidcarve schema > schema.json      named in a pipeline's first line:\n"
         "  # yaml-language-server: $schema=schema.json"},
        {"graph", "  fluidcarve graph shot.yaml --format svg > shot.svg"},
        {"inspect",
         "  fluidcarve inspect /shots/sh010/*.vdb\n"
         "  fluidcarve inspect /shots/sh010/smoke.####.vdb      the sequence as one\n"
         "  fluidcarve inspect /shots/sh010                     all files of a folder"},
        {"diff",
         "  fluidcarve diff before.####.vdb after.####.vdb\n"
         "  fluidcarve diff before.####.vdb after.####.vdb -f 51-56 --fail 1e-4 --fail-percent 0.1 --picture worst.png\n"
         "  fluidcarve diff out/monday out/tuesday --json"},
        {"explain", "  fluidcarve explain out/plume.0051.vdb\n  fluidcarve explain --json out/sheet.png"},
        {"man", "  fluidcarve man | man -l -"},
        {"completion",
         "  source <(fluidcarve completion bash)      in ~/.bashrc\n"
         "  source <(fluidcarve completion zsh)       in ~/.zshrc, after compinit"}};
    for (auto* const verb : app.get_subcommands([](CLI::App*) { return true; }))
        if (const auto found = examples.find(verb->get_name()); found != examples.end()) verb->footer(std::string("Examples:\n") + found->second);
}

/// A message if the first argument should be a verb and is not one; else empty.
std::string wrong_verb(const CLI::App& app, int argc, const char* const* argv) {
    std::vector<std::string> names;
    for (const auto* const verb : app.get_subcommands([](const CLI::App*) { return true; })) names.push_back(verb->get_name());
    if (argc < 2) return fmt::format("fluidcarve wants a verb: {}; `fluidcarve VERB --help` says more\n", fmt::join(names, ", "));
    const std::string first = argv[1];
    if (first.starts_with('-') || std::find(names.begin(), names.end(), first) != names.end()) return {};
    return fmt::format("there is no verb '{}'{}\n", first, did_you_mean(first, names));
}

}  // namespace

int run_command_line(int argc, const char* const* argv, Registry registry) {
    CLI::App app("Changes the size of a finished simulation without simulating it again: carves seams out of volume sequences, or inserts them.", "fluidcarve");
    app.set_version_flag("--version", std::string("fluidcarve ") + FLUIDCARVE_VERSION);
    app.require_subcommand(1);
    app.failure_message(CLI::FailureMessage::simple);

    PipelineArguments pipeline;
    RunArguments run_arguments, plan_arguments;  // one per verb: environment variables set the options of both
    bool json = false;
    bool verbose = false;
    bool markdown = false;
    std::string type;
    std::string format = "dot";

    auto* const run_verb = app.add_subcommand("run", "Run a pipeline");
    pipeline.declare(*run_verb);
    run_arguments.declare(*run_verb);
    auto* const check_verb = app.add_subcommand("check", "Find all faults of a pipeline without running it");
    pipeline.declare(*check_verb);
    check_verb->add_flag("--json", json, "Print problems as JSON; with --verbose, print the values if there are no problems");
    check_verb->add_flag("-v,--verbose", verbose, "Show each value of the pipeline and its origin, and where the files lie");
    auto* const plan_verb =
        app.add_subcommand("plan", "Show what a run will do, node by node, why, and in which time by earlier runs; takes the options of `run`");
    pipeline.declare(*plan_verb);
    plan_arguments.declare(*plan_verb);
    plan_verb->add_flag("--json", json, "Print as JSON");
    std::string status_folder = RunOptions().work_folder, clean_folder = status_folder;
    auto* const status_verb = app.add_subcommand("status", "Show how far the runs in a work folder have come, and which were interrupted");
    status_verb->add_option("--work", status_folder, "The work folder")->capture_default_str()->type_name("DIR")->envname("FLUIDCARVE_WORK");
    status_verb->add_flag("--json", json, "Print as JSON");
    auto* const clean_verb = app.add_subcommand("clean", "Remove all results from a work folder");
    clean_verb->add_option("--work", clean_folder, "The work folder")->capture_default_str()->type_name("DIR")->envname("FLUIDCARVE_WORK");
    auto* const nodes_verb = app.add_subcommand("nodes", "List the node types, or those of a family, or describe one");
    nodes_verb->add_option("type", type, "The node type to describe, or the family to list")->type_name("TYPE");
    auto* const json_flag = nodes_verb->add_flag("--json", json, "Print as JSON");
    nodes_verb->add_flag("--markdown", markdown, "Print as Markdown")->excludes(json_flag);
    auto* const schema_verb = app.add_subcommand("schema", "Print the JSON schema (draft 7) of pipeline files, for editors");
    std::vector<std::string> plugins;
    for (auto* const verb : {nodes_verb, schema_verb})
        verb->add_option("--plugin", plugins, "Include the types of this plugin; its code is loaded; may be repeated")
            ->type_name("FILE")
            ->expected(1)
            ->take_all();
    NewNode new_node;
    auto* const new_node_verb = app.add_subcommand("new-node", "Write a plugin with a node type of your own: source, test, build files, a pipeline");
    new_node_verb->add_option("name", new_node.name, "Name of the node type: FAMILY.NAME, such as acme.sparkle; choose a family of your own")
        ->required()
        ->type_name("NAME");
    new_node_verb->add_flag("--solver", new_node.solver, "Write a solver instead of an energy");
    new_node_verb->add_option("--folder", new_node.folder, "The folder to write (default: ./FAMILY_NAME)")->type_name("DIR");
    auto* const graph_verb = app.add_subcommand("graph", "Draw a pipeline");
    pipeline.declare(*graph_verb);
    graph_verb->add_option("--format", format, "Format of the picture")->check(CLI::IsMember({"dot", "svg"}))->capture_default_str();

    std::vector<std::string> files;
    auto* const inspect_verb = app.add_subcommand("inspect", "Show the content of volumes, images, meshes, points and curves; sequences as one");
    inspect_verb->add_option("files", files, "Data files, sequences such as smoke.####.vdb, and folders")->required()->type_name("FILE");
    inspect_verb->add_flag("--json", json, "Print as JSON");

    std::string made;
    auto* const explain_verb = app.add_subcommand("explain", "Show what made a file: program, pipeline, values, seams, and the command that makes it again");
    explain_verb->add_option("file", made, "A file that a run wrote (.vdb, .png, .exr, .jpg, .ply, .obj)")->required()->type_name("FILE");
    explain_verb->add_flag("--json", json, "Print as JSON");

    DiffArguments diff_arguments;
    auto* const diff_verb = app.add_subcommand("diff", "Compare two sequences, files or folders, grid by grid");
    diff_arguments.declare(*diff_verb);
    diff_verb->add_flag("--json", json, "Print as JSON");

    std::string shell;
    auto* const man_verb = app.add_subcommand("man", "Print the manual page");
    auto* const completion_verb = app.add_subcommand("completion", "Print a script that completes commands in a shell");
    completion_verb->add_option("shell", shell, "The shell")->required()->check(CLI::IsMember({"bash", "zsh"}))->type_name("SHELL");
    add_examples(app);

    if (const auto fault = wrong_verb(app, argc, argv); !fault.empty()) return complain(fault), exit_code::usage;
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error, std::cout, std::cerr) == 0 ? exit_code::done : exit_code::usage;
    }
    try {
        Confinement::confine_program(pipeline.folders);
    } catch (const Failure& failure) {
        return complain(fmt::format("{}\n", failure.what())), exit_code::usage;
    }
    if (*run_verb) return run(pipeline, run_arguments, registry);
    if (*check_verb) return check(pipeline, json, verbose, registry);
    if (*plan_verb) return plan(pipeline, plan_arguments, json, registry);
    if (*status_verb) return print(status_text(status_folder, json)), exit_code::done;
    if (*clean_verb) return clean(clean_folder);
    if (*new_node_verb) return write_new_node(new_node, registry);
    if (!load_or_complain(plugins, registry)) return exit_code::usage;
    if (*nodes_verb) return nodes(type, json, markdown, registry);
    if (*man_verb) return print(man_page(app, FLUIDCARVE_VERSION)), exit_code::done;
    if (*completion_verb) return print(completion(app, shell)), exit_code::done;
    if (*schema_verb) return print(schema(registry)), exit_code::done;
    if (*diff_verb) return diff_files(diff_arguments.read(json), registry);
    if (*inspect_verb) return inspect_files(files, json, half_of_memory(), registry);
    if (*explain_verb) return explain_file(made, json, half_of_memory(), registry);
    return graph(pipeline, format, registry);
}

}  // namespace fluidcarve
