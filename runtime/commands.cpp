#include "runtime/commands.h"

#include "graph/describe.h"
#include "graph/drawing.h"
#include "graph/schema.h"
#include "runtime/inspect.h"
#include "runtime/interrupt.h"
#include "runtime/run.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <unistd.h>
#include <algorithm>
#include <cstdlib>
#include <thread>

namespace fluidcarve {
namespace {

void print(const std::string& text) { std::fwrite(text.data(), 1, text.size(), stdout); }
void complain(const std::string& text) { std::fwrite(text.data(), 1, text.size(), stderr); }

/// "8G", "500M", "1.5 GiB" to bytes; powers of 1024.
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

/// What the verbs that take a pipeline share.
struct PipelineArguments {
    std::string path;
    std::vector<std::string> settings;

    void declare(CLI::App& verb) {
        verb.add_option("pipeline", path, "Pipeline file (YAML)")->required()->type_name("PIPELINE");
        verb.add_option("--set", settings, "Override a field of a node or a param; may be repeated")
            ->type_name("NODE.FIELD=VALUE|PARAM=VALUE")
            ->expected(1)
            ->take_all();
    }

    /// Nothing where there are problems.
    std::optional<Pipeline> read(const Registry& registry, Problems& problems) const {
        const auto document = read_document(path, settings, problems);
        auto pipeline = build_pipeline(document, registry, problems);
        return problems.empty() ? std::optional(std::move(pipeline)) : std::nullopt;
    }

    std::optional<Pipeline> read_or_complain(const Registry& registry) const {
        Problems problems;
        auto pipeline = read(registry, problems);
        complain(to_text(problems));
        return pipeline;
    }
};

struct RunArguments {
    std::string frames;
    std::string to;
    int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    int in_flight = 0;
    std::string memory;
    std::string progress = "auto";
    RunRequest request;
    const CLI::Option* frames_option = nullptr;  ///< an empty -f, as from an unset variable of a farm's script, is wrong, not "all"

    void declare(CLI::App& verb) {
        frames_option = verb.add_option("-f,--frames", frames, "Deliver only these frames of the sequence (1001-1010,1020)")->type_name("FRAMES");
        verb.add_option("--to", to, "Run this node and what it needs, nothing else")->type_name("NODE");
        verb.add_option("--threads", threads, "Threads")->check(CLI::Range(1, 4096))->capture_default_str();
        verb.add_option("--in-flight", in_flight, "Frames alive at once (default: threads + 1)")->check(CLI::Range(1, 100000));
        verb.add_option("--memory", memory, "What a node may hold for the whole sequence before it uses files (default: half of the machine's)")
            ->type_name("SIZE");
        verb.add_option("--work", request.options.work_folder, "Folder for such files")->capture_default_str()->type_name("DIR");
        verb.add_option("--report", request.report_path, "Write what happened to this file")->type_name("FILE.json");
        verb.add_option("--progress", progress, "How to show progress")->check(CLI::IsMember({"auto", "bar", "json", "none"}))->capture_default_str();
        verb.add_flag("--keep-going", request.options.keep_going, "Run the other frames when one fails");
        const auto quiet = verb.add_flag("-q,--quiet", request.quiet, "Tell failures only");
        verb.add_flag("-v,--verbose", request.verbose, "Show the plan and the time of each node")->excludes(quiet);
    }

    /// Nothing where an argument is wrong; it has been told.
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
        if (!to.empty() && !pipeline.find(to)) return wrong(fmt::format("--to: there is no node '{}'{}", to, did_you_mean(to, pipeline.node_names())));
        request.to = to;
        if (const auto user = request.report_path.empty() ? std::string() : user_of(pipeline, request.report_path); !user.empty())
            return wrong(fmt::format("--report would overwrite {}: {}", request.report_path, user));
        const char* const no_color = std::getenv("NO_COLOR");
        const bool terminal = isatty(STDERR_FILENO) != 0 && (!no_color || *no_color == '\0');
        request.progress = progress == "none" || request.quiet                     ? ProgressStyle::none
                           : progress == "bar" || (progress == "auto" && terminal) ? ProgressStyle::bar
                                                                                   : ProgressStyle::json;
        return request;
    }
};

int run(const PipelineArguments& arguments, RunArguments& run_arguments, const Registry& registry) {
    const auto pipeline = arguments.read_or_complain(registry);
    if (!pipeline) return exit_code::usage;
    const auto request = run_arguments.read(*pipeline);
    if (!request) return exit_code::usage;
    const Interrupt interrupt;
    return run_pipeline(*pipeline, registry, *request, [&] { return interrupt.asked(); });
}

int check(const PipelineArguments& arguments, bool json, const Registry& registry) {
    Problems problems;
    const auto pipeline = arguments.read(registry, problems);
    if (json) print(to_json(problems));
    else if (pipeline) print(fmt::format("{}: good; {} nodes, {} frames\n", arguments.path, pipeline->nodes.size(), pipeline->frames.frames().size()));
    else complain(to_text(problems));
    return pipeline ? exit_code::done : exit_code::usage;
}

int plan(const PipelineArguments& arguments, const Registry& registry) {
    const auto pipeline = arguments.read_or_complain(registry);
    if (!pipeline) return exit_code::usage;
    print(to_text(make_plan(*pipeline, {}), *pipeline, pipeline->frames.frames().size()));
    return exit_code::done;
}

int nodes(const std::string& type, bool json, bool markdown, const Registry& registry) {
    if (!type.empty()) {
        const auto* const found = registry.node(type);
        if (!found) return complain(fmt::format("there is no node type '{}'{}\n", type, did_you_mean(type, registry.node_names()))), exit_code::usage;
        print(json ? to_json(registry, *found) : markdown ? to_markdown(registry, *found) : describe(registry, *found));
    } else {
        print(json ? to_json(registry) : markdown ? to_markdown(registry) : listing(registry));
    }
    return exit_code::done;
}

int graph(const PipelineArguments& arguments, const std::string& format, const Registry& registry) {
    const auto pipeline = arguments.read_or_complain(registry);
    if (!pipeline) return exit_code::usage;
    print(format == "svg" ? to_svg(*pipeline, registry) : to_dot(*pipeline, registry));
    return exit_code::done;
}

}  // namespace

int run_command_line(int argc, const char* const* argv, const Registry& registry) {
    CLI::App app("Carves seams out of volume sequences, or into them: resize a finished simulation without simulating it again.", "fluidcarve");
    app.set_version_flag("--version", std::string("fluidcarve ") + FLUIDCARVE_VERSION);
    app.require_subcommand(1);
    app.failure_message(CLI::FailureMessage::simple);

    PipelineArguments pipeline;
    RunArguments run_arguments;
    bool json = false;
    bool markdown = false;
    std::string type;
    std::string format = "dot";

    auto* const run_verb = app.add_subcommand("run", "Run a pipeline");
    pipeline.declare(*run_verb);
    run_arguments.declare(*run_verb);
    auto* const check_verb = app.add_subcommand("check", "Find everything that is wrong with a pipeline, without running it");
    pipeline.declare(*check_verb);
    check_verb->add_flag("--json", json, "Problems as JSON");
    auto* const plan_verb = app.add_subcommand("plan", "Show the passes of a run and their frames");
    pipeline.declare(*plan_verb);
    auto* const nodes_verb = app.add_subcommand("nodes", "List the node types, or describe one");
    nodes_verb->add_option("type", type, "A node type, for its description")->type_name("TYPE");
    auto* const json_flag = nodes_verb->add_flag("--json", json, "As JSON");
    nodes_verb->add_flag("--markdown", markdown, "As Markdown")->excludes(json_flag);
    auto* const schema_verb = app.add_subcommand("schema", "Print the JSON schema (draft 7) of pipeline files, for editors");
    auto* const graph_verb = app.add_subcommand("graph", "Draw a pipeline");
    pipeline.declare(*graph_verb);
    graph_verb->add_option("--format", format, "Language of the picture")->check(CLI::IsMember({"dot", "svg"}))->capture_default_str();

    std::vector<std::string> files;
    auto* const inspect_verb = app.add_subcommand("inspect", "Say what is in data files: grids, types, transforms, ranges, oddities");
    inspect_verb->add_option("files", files, "Data files (.vdb)")->required()->type_name("FILE");
    inspect_verb->add_flag("--json", json, "As JSON");

    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error, std::cout, std::cerr) == 0 ? exit_code::done : exit_code::usage;
    }
    if (*run_verb) return run(pipeline, run_arguments, registry);
    if (*check_verb) return check(pipeline, json, registry);
    if (*plan_verb) return plan(pipeline, registry);
    if (*nodes_verb) return nodes(type, json, markdown, registry);
    if (*schema_verb) return print(schema(registry)), exit_code::done;
    if (*inspect_verb) return inspect_files(files, json, half_of_memory(), registry);
    return graph(pipeline, format, registry);
}

}  // namespace fluidcarve
