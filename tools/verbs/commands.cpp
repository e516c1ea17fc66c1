#include "tools/verbs/commands.h"

#include "carve/base/words.h"
#include "formats/file/confinement.h"
#include "graph/code_trust.h"
#include "runtime/tell/exit_codes.h"
#include "runtime/tell/terminal.h"
#include "tools/verbs/examples.h"
#include "tools/verbs/verbs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <memory>

namespace fluidcarve {

namespace {

/// In the order of the help.
constexpr Verb all_verbs[] = {
    {"run", "Run a pipeline", run_verb},
    {"check", "Find all faults of a pipeline without running it", check_verb},
    {"plan",
     "Show what a run will do, node by node, why, and in which time by earlier runs; takes the "
     "options of `run`",
     plan_verb},
    {"farm",
     "Run a pipeline as steps on many machines, or as processes on this one; takes the options of "
     "`run`",
     farm_verb},
    {"view", "Write a page for a browser: before and after, with a slider for the number of seams",
     view_verb},
    {"status",
     "Show how far the runs and farm jobs in a work folder have come, and which were interrupted",
     status_verb},
    {"clean", "Remove results from a work folder", clean_verb},
    {"nodes", "List the node types, or those of a family, or describe one", nodes_verb},
    {"schema", "Print the JSON schema (draft 7) of pipeline files, for editors", schema_verb},
    {"wedge",
     "Run a pipeline with several values of its params, and show the results side by side; takes "
     "the options of `run`",
     wedge_verb},
    {"carve",
     "Carve files in the box around them, without a pipeline of your own; takes the options of "
     "`run`",
     carve_verb},
    {"init", "Look at files, and write the commented pipeline that carves them", init_verb},
    {"new-node",
     "Write a plugin with a node type of your own: source, test, build files, a pipeline",
     new_node_verb},
    {"graph", "Draw a pipeline", graph_verb},
    {"inspect", "Show the content of volumes, images, meshes, points and curves; sequences as one",
     inspect_verb},
    {"explain",
     "Show what made a file: program, pipeline, values, seams, and the command that makes it again",
     explain_verb},
    {"diff", "Compare two sequences, files or folders, grid by grid", diff_verb},
    {"man", "Print the manual page", man_verb},
    {"completion", "Print a script that completes commands in a shell", completion_verb},
};

/// A message if the first argument should be a verb and is not one; else empty.
std::string wrong_verb(const CLI::App& app, int argc, const char* const* argv) {
    std::vector<std::string> names;
    for (const auto* const verb : app.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(verb->get_name());
    if (argc < 2)
        return fmt::format("fluidcarve needs a verb: {}; `fluidcarve VERB --help` says more\n",
                           fmt::join(names, ", "));
    const std::string first = argv[1];
    if (first.starts_with('-') || std::ranges::find(names, first) != names.end()) return {};
    return fmt::format("there is no verb '{}'{}\n", first, did_you_mean(first, names));
}

/// Whether a verb runs with progress told as events.
bool tells_events(const CLI::App& verb) {
    const auto* const progress = verb.get_option_no_throw("--progress");
    return progress && progress->count() > 0 && progress->as<std::string>() == "json";
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
    Program program{app, registry, pipeline, {argv, argv + argc}};
    std::map<const CLI::App*, Verb::Work> works;
    for (const auto& verb : all_verbs) {
        auto* const declared = app.add_subcommand(verb.name, verb.doc);
        works[declared] = verb.declare(*declared, program);
    }
    add_examples(app);

    if (const auto fault = wrong_verb(app, argc, argv); !fault.empty())
        return complain(fault), exit_code::usage;
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error, std::cout, std::cerr) == 0 ? exit_code::done : exit_code::usage;
    }
    const auto* const verb = app.get_subcommands().front();
    if (tells_events(*verb)) tell_as_events();
    if (pipeline.allow_plugins) allow_code();
    try {
        Confinement::confine_program(pipeline.folders);
    } catch (const Failure& failure) {
        return end_with(failure.what());
    }
    return works.at(verb)();
}

}  // namespace fluidcarve
