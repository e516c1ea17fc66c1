#include "tools/verbs/commands.h"

#include "carve/base/words.h"
#include "formats/file/confinement.h"
#include "graph/code_trust.h"
#include "graph/views/describe.h"
#include "graph/views/drawing.h"
#include "graph/views/file_places.h"
#include "graph/views/provenance.h"
#include "graph/views/schema.h"
#include "graph/views/value_sources.h"
#include "runtime/jobs/job_status.h"
#include "runtime/keep/work_folder.h"
#include "runtime/run/interrupt.h"
#include "runtime/run/run.h"
#include "runtime/tell/outcome.h"
#include "runtime/tell/terminal.h"
#include "tools/verbs/arguments.h"
#include "tools/verbs/carve.h"
#include "tools/verbs/diff.h"
#include "tools/verbs/examples.h"
#include "tools/verbs/explain.h"
#include "tools/verbs/farm.h"
#include "tools/verbs/init.h"
#include "tools/verbs/inspect.h"
#include "tools/verbs/new_node.h"
#include "tools/verbs/shell.h"
#include "tools/verbs/view.h"
#include "tools/verbs/wedge.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <map>
#include <optional>

namespace fluidcarve {

namespace {

int run(const PipelineArguments& arguments, RunArguments& run_arguments, Registry& registry) {
    Problems problems;
    const auto document = read_document(arguments.path, arguments.settings, problems);
    auto pipeline = arguments.build(document, registry, problems);
    if (!problems.empty()) return complain(to_text(problems)), exit_code::usage;
    state_provenance(pipeline, document, registry);
    auto request = run_arguments.read(pipeline);
    if (!request) return exit_code::usage;
    request->sources = value_sources_of(document, registry);
    const Interrupt interrupt(request->quiet ? std::string()
                                             : interrupted_text(request->options.cache));
    return run_pipeline(pipeline, registry, *request, [&] { return interrupt.asked(); });
}

/// @param open  whether the pipeline is a template, whose params may have no value
int check(const PipelineArguments& arguments, bool json, bool verbose, bool open,
          Registry& registry) {
    Problems problems;
    const auto document = read_document(arguments.path, arguments.settings, problems, open);
    const auto pipeline = arguments.build(document, registry, problems);
    if (!problems.empty())
        return json ? print(to_json(problems)) : complain(to_text(problems)), exit_code::usage;
    const auto values = [&] {
        auto out = value_sources_of(document, registry);
        out.files = file_places(pipeline);
        return out;
    };
    const auto warnings = warnings_of(pipeline);
    if (json) return print(verbose ? to_json(values()) : to_json(warnings)), exit_code::done;
    complain(to_text(warnings));
    print(fmt::format("{}: good; {}, {}\n", arguments.path, counted(pipeline.nodes.size(), "node"),
                      counted(pipeline.frames.frames().size(), "frame")));
    if (verbose) print("\n" + to_text(values()));
    return exit_code::done;
}

int plan(const PipelineArguments& arguments, RunArguments& run_arguments, bool json,
         Registry& registry) {
    const auto pipeline = arguments.read_or_complain(registry);
    if (!pipeline) return exit_code::usage;
    const auto request = run_arguments.read(*pipeline);
    return request ? plan_pipeline(*pipeline, registry, *request, json) : exit_code::usage;
}

/// An age such as 7d, 12h, 30m or 2w; nothing if a text is none.
std::optional<std::chrono::seconds> age_of(std::string_view text) {
    static const std::map<char, std::chrono::seconds> units{{'m', std::chrono::minutes(1)},
                                                            {'h', std::chrono::hours(1)},
                                                            {'d', std::chrono::hours(24)},
                                                            {'w', std::chrono::hours(24 * 7)}};
    const auto unit = text.empty() ? units.end() : units.find(text.back());
    if (unit == units.end()) return std::nullopt;
    text.remove_suffix(1);
    int number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{} || end != text.data() + text.size() || number < 0 || number > 100000)
        return std::nullopt;
    return number * unit->second;
}

/// Says how far the runs in a work folder have come.
int status(const std::string& folder, bool json) {
    if (const auto fault = WorkFolder(folder).unread(); !fault.empty())
        return complain("failed: " + fault + "\n"), exit_code::input;
    return print(job_status_text(folder, json)), exit_code::done;
}

/// Removes files of fluidcarve from a work folder, and the folder if it is then empty.
int clean(const std::string& path, const std::string& older, const std::string& shot,
          bool dry_run) {
    const WorkFolder folder(path);
    WorkFolder::Wish wish{older.empty() ? std::nullopt : age_of(older), dry_run,
                          shot.empty() ? std::nullopt : std::optional(shot)};
    if (!older.empty() && !wish.older)
        return complain(fmt::format("--older: '{}' is no age such as 7d, 12h, 30m or 2w\n", older)),
               exit_code::usage;
    if (const auto fault = folder.unread(); !fault.empty())
        return complain("failed: " + fault + "\n"), exit_code::input;
    if (const auto fault = folder.fault(); !fault.empty())
        return complain(fmt::format("cannot clean: {}\n", fault)), exit_code::usage;
    try {
        const auto cleaned = folder.clean(wish);
        const auto stay = [](std::size_t count, const char* why) {
            return count == 0 ? std::string()
                              : fmt::format("; {} {} {}", count,
                                            count == 1 ? "file stays" : "files stay", why);
        };
        const auto rest = stay(cleaned.kept, "that were used since") +
                          stay(cleaned.apart, "of other shots, or of several") +
                          stay(cleaned.left, "that fluidcarve did not write");
        const auto what =
            fmt::format("{}, {}", counted(cleaned.removed, "file"), size_text(cleaned.bytes));
        print(fmt::format("{}: {}{}\n", path,
                          cleaned.removed == 0 ? "nothing to clean"
                          : dry_run            ? "would remove " + what
                                               : "removed " + what,
                          rest));
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
    if (name.find('.') != std::string::npos)
        return fmt::format("there is no node type '{}'{}\n", name, did_you_mean(name, names));
    std::vector<std::string> quoted;
    for (const auto& each : names)
        if (each.ends_with("." + name)) quoted.push_back("'" + each + "'");
    return fmt::format("there is no node type or family '{}'{}\n", name,
                       quoted.empty() ? did_you_mean(name, registry.families())
                                      : fmt::format("; did you mean {}?", either(quoted)));
}

int nodes(const std::string& type, bool json, bool markdown, const Registry& registry) {
    const auto families = registry.families();
    if (std::find(families.begin(), families.end(), type) != families.end()) {
        print(json       ? family_to_json(registry, type)
              : markdown ? family_to_markdown(registry, type)
                         : listing(registry, type));
    } else if (!type.empty()) {
        const auto* const found = registry.node(type);
        if (!found) return complain(no_node_type(type, registry)), exit_code::usage;
        print(json       ? to_json(registry, *found)
              : markdown ? to_markdown(registry, *found)
                         : describe(registry, *found));
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

/// A message if the first argument should be a verb and is not one; else empty.
std::string wrong_verb(const CLI::App& app, int argc, const char* const* argv) {
    std::vector<std::string> names;
    for (const auto* const verb : app.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(verb->get_name());
    if (argc < 2)
        return fmt::format("fluidcarve needs a verb: {}; `fluidcarve VERB --help` says more\n",
                           fmt::join(names, ", "));
    const std::string first = argv[1];
    if (first.starts_with('-') || std::find(names.begin(), names.end(), first) != names.end())
        return {};
    return fmt::format("there is no verb '{}'{}\n", first, did_you_mean(first, names));
}

}  // namespace

int run_command_line(int argc, const char* const* argv, Registry registry) {
    CLI::App app(
        "Changes the size of a finished simulation without simulating it again: carves seams out "
        "of volume sequences, or inserts them.",
        "fluidcarve");
    app.set_version_flag("--version", std::string("fluidcarve ") + FLUIDCARVE_VERSION);
    app.require_subcommand(1);
    app.failure_message(CLI::FailureMessage::simple);

    PipelineArguments pipeline;
    RunArguments run_arguments,
        plan_arguments;  // one per verb: environment variables set the options of both
    bool json = false;
    bool verbose = false;
    bool markdown = false;
    std::string type;
    std::string format = "dot";

    auto* const run_verb = app.add_subcommand("run", "Run a pipeline");
    pipeline.declare(*run_verb);
    run_arguments.declare(*run_verb);
    auto* const check_verb =
        app.add_subcommand("check", "Find all faults of a pipeline without running it");
    pipeline.declare(*check_verb);
    check_verb->add_flag(
        "--json", json,
        "Print problems as JSON; with --verbose, print the values if there are no problems");
    check_verb->add_flag("-v,--verbose", verbose,
                         "Show each value of the pipeline and its source, and where the files lie");
    bool open = false;
    check_verb->add_flag("--template", open,
                         "Let params have no value, as those of a template that shots extend");
    auto* const plan_verb =
        app.add_subcommand("plan",
                           "Show what a run will do, node by node, why, and in which time by "
                           "earlier runs; takes the options of `run`");
    pipeline.declare(*plan_verb);
    plan_arguments.declare(*plan_verb);
    plan_verb->add_flag("--json", json, "Print as JSON");
    FarmArguments farm_arguments;
    RunArguments farm_run_arguments;
    auto* const farm_verb = app.add_subcommand("farm",
                                               "Run a pipeline as steps on many machines, or as "
                                               "processes on this one; takes the options of `run`");
    farm_arguments.declare(*farm_verb, pipeline, farm_run_arguments);
    ViewArguments view;
    auto* const view_verb = app.add_subcommand(
        "view",
        "Write a page for a browser: before and after, with a slider for the number of seams");
    pipeline.declare(*view_verb);
    view.declare(*view_verb);
    std::string status_folder = RunOptions().work_folder, clean_folder = status_folder;
    auto* const status_verb = app.add_subcommand("status",
                                                 "Show how far the runs and farm jobs in a work "
                                                 "folder have come, and which were interrupted");
    status_verb->add_option("--work", status_folder, "The work folder")
        ->capture_default_str()
        ->type_name("DIR")
        ->envname("FLUIDCARVE_WORK");
    status_verb->add_flag("--json", json, "Print as JSON");
    auto* const clean_verb = app.add_subcommand("clean", "Remove results from a work folder");
    clean_verb->add_option("--work", clean_folder, "The work folder")
        ->capture_default_str()
        ->type_name("DIR")
        ->envname("FLUIDCARVE_WORK");
    std::string older;
    std::string shot;
    bool dry_run = false;
    clean_verb
        ->add_option("--shot", shot,
                     "Remove only what runs of this pipeline made: the name of its file, as in "
                     "sh010 for sh010.yaml. Results of up to 64 KB, which "
                     "lie many to a file, stay")
        ->type_name("NAME");
    clean_verb
        ->add_option("--older", older,
                     "Remove only what was not used for so long: 7d, 12h, 30m, 2w")
        ->type_name("AGE");
    clean_verb->add_flag("--dry-run", dry_run, "Only say what would be removed");
    auto* const nodes_verb =
        app.add_subcommand("nodes", "List the node types, or those of a family, or describe one");
    nodes_verb->add_option("type", type, "The node type to describe, or the family to list")
        ->type_name("TYPE");
    auto* const json_flag = nodes_verb->add_flag("--json", json, "Print as JSON");
    nodes_verb->add_flag("--markdown", markdown, "Print as Markdown")->excludes(json_flag);
    auto* const schema_verb = app.add_subcommand(
        "schema", "Print the JSON schema (draft 7) of pipeline files, for editors");
    std::vector<std::string> plugins;
    for (auto* const verb : {nodes_verb, schema_verb})
        verb->add_option("--plugin", plugins,
                         "Include the types of this plugin; its code is loaded; may be repeated")
            ->type_name("FILE")
            ->expected(1)
            ->take_all();
    WedgeArguments wedge_arguments;
    auto* const wedge_verb =
        app.add_subcommand("wedge",
                           "Run a pipeline with several values of its params, and show the results "
                           "side by side; takes the options of `run`");
    pipeline.declare(*wedge_verb);
    wedge_arguments.declare(*wedge_verb);
    CarveArguments carve_arguments;
    auto* const carve_verb = app.add_subcommand("carve",
                                                "Carve files in the box around them, without a "
                                                "pipeline of your own; takes the options of `run`");
    carve_arguments.declare(*carve_verb);
    InitArguments init_arguments;
    auto* const init_verb = app.add_subcommand(
        "init", "Look at files, and write the commented pipeline that carves them");
    init_arguments.declare(*init_verb);
    NewNode new_node;
    auto* const new_node_verb = app.add_subcommand(
        "new-node",
        "Write a plugin with a node type of your own: source, test, build files, a pipeline");
    new_node_verb
        ->add_option(
            "name", new_node.name,
            "Name of the node type: FAMILY.NAME, such as acme.sparkle; choose a family of your own")
        ->required()
        ->type_name("NAME");
    auto* const solver_flag =
        new_node_verb->add_flag("--solver", new_node.solver, "Write a solver instead of an energy");
    new_node_verb
        ->add_flag("--python", new_node.python,
                   "Write an energy as a script of Python, with its test and a pipeline, instead "
                   "of a plugin")
        ->excludes(solver_flag);
    new_node_verb
        ->add_option("--folder", new_node.folder, "The folder to write (default: ./FAMILY_NAME)")
        ->type_name("DIR");
    auto* const graph_verb = app.add_subcommand("graph", "Draw a pipeline");
    pipeline.declare(*graph_verb);
    graph_verb->add_option("--format", format, "Format of the picture")
        ->check(CLI::IsMember({"dot", "svg"}))
        ->capture_default_str();

    std::vector<std::string> files;
    auto* const inspect_verb = app.add_subcommand(
        "inspect",
        "Show the content of volumes, images, meshes, points and curves; sequences as one");
    inspect_verb
        ->add_option("files", files, "Data files, sequences such as smoke.####.vdb, and folders")
        ->required()
        ->type_name("FILE");
    inspect_verb->add_flag("--json", json, "Print as JSON");

    std::string made;
    auto* const explain_verb =
        app.add_subcommand("explain",
                           "Show what made a file: program, pipeline, values, seams, and the "
                           "command that makes it again");
    explain_verb
        ->add_option("file", made, "A file that a run wrote (.vdb, .png, .exr, .jpg, .ply, .obj)")
        ->required()
        ->type_name("FILE");
    explain_verb->add_flag("--json", json, "Print as JSON");

    DiffArguments diff_arguments;
    auto* const diff_verb =
        app.add_subcommand("diff", "Compare two sequences, files or folders, grid by grid");
    diff_arguments.declare(*diff_verb);
    diff_verb->add_flag("--json", json, "Print as JSON");

    std::string shell;
    auto* const man_verb = app.add_subcommand("man", "Print the manual page");
    auto* const completion_verb =
        app.add_subcommand("completion", "Print a script that completes commands in a shell");
    completion_verb->add_option("shell", shell, "The shell")
        ->required()
        ->check(CLI::IsMember({"bash", "zsh", "fish"}))
        ->type_name("SHELL");
    add_examples(app);

    if (const auto fault = wrong_verb(app, argc, argv); !fault.empty())
        return complain(fault), exit_code::usage;
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error, std::cout, std::cerr) == 0 ? exit_code::done : exit_code::usage;
    }
    for (const auto* const each : {&run_arguments, &carve_arguments.run})
        if (each->progress == "json") tell_as_events();
    if (pipeline.allow_plugins) allow_code();
    try {
        Confinement::confine_program(pipeline.folders);
    } catch (const Failure& failure) {
        return complain(fmt::format("{}\n", failure.what())), exit_code::usage;
    }
    if (*run_verb) return run(pipeline, run_arguments, registry);
    if (*check_verb) return check(pipeline, json, verbose, open, registry);
    if (*plan_verb) return plan(pipeline, plan_arguments, json, registry);
    if (*farm_verb)
        return farm(farm_arguments, pipeline, farm_run_arguments, {argv, argv + argc}, registry);
    if (*status_verb) return status(status_folder, json);
    if (*view_verb) return view_pipeline(pipeline, view, registry);
    if (*clean_verb) return clean(clean_folder, older, shot, dry_run);
    if (*wedge_verb) return wedge_pipeline(pipeline, wedge_arguments, registry);
    if (*carve_verb) return carve_files(carve_arguments, registry);
    if (*init_verb) return init_pipeline(init_arguments, registry);
    if (*new_node_verb) return write_new_node(new_node, registry);
    if (!load_or_complain(plugins, registry)) return exit_code::usage;
    if (*nodes_verb) return nodes(type, json, markdown, registry);
    if (*man_verb) return print(man_page(app, FLUIDCARVE_VERSION)), exit_code::done;
    if (*completion_verb) return print(completion(app, shell)), exit_code::done;
    if (*schema_verb) return print(schema(registry)), exit_code::done;
    if (*diff_verb) return diff_files(diff_arguments.read(json));
    if (*inspect_verb) return inspect_files(files, json, half_of_memory());
    if (*explain_verb) return explain_file(made, json, half_of_memory());
    return graph(pipeline, format, registry);
}

}  // namespace fluidcarve
