#include "tools/verbs/run.h"

#include "carve/base/words.h"
#include "graph/provenance.h"
#include "graph/views/drawing.h"
#include "graph/views/file_places.h"
#include "graph/views/value_sources.h"
#include "runtime/run/interrupt.h"
#include "runtime/run/run.h"
#include "runtime/tell/outcome.h"
#include "tools/verbs/verbs.h"

#include <fmt/format.h>

#include <memory>
#include <utility>

namespace fluidcarve {

int run_built(Pipeline pipeline, const Document& document, RunArguments& arguments,
              const Registry& registry) {
    state_provenance(pipeline, document, registry);
    auto request = arguments.read(pipeline);
    if (!request) return exit_code::usage;
    request->sources = value_sources_of(document, registry);
    const Interrupt interrupt(request->quiet ? std::string()
                                             : interrupted_text(request->options.cache));
    return run_pipeline(pipeline, registry, *request, [&] { return interrupt.asked(); });
}

namespace {

int run(const PipelineArguments& arguments, RunArguments& run_arguments, Registry& registry) {
    Problems problems;
    const auto document = read_document(arguments.path, arguments.settings, problems);
    auto pipeline = arguments.build(document, registry, problems);
    if (!problems.empty()) return end_with(problems);
    return run_built(std::move(pipeline), document, run_arguments, registry);
}

/// @param open  whether the pipeline is a template, whose params may have no value
int check(const PipelineArguments& arguments, bool json, bool verbose, bool open,
          Registry& registry) {
    Problems problems;
    const auto document = read_document(arguments.path, arguments.settings, problems, open);
    const auto pipeline = arguments.build(document, registry, problems);
    if (!problems.empty())
        return json ? print_json(to_json(problems)) : complain(to_text(problems)), exit_code::usage;
    const auto values = [&] {
        auto out = value_sources_of(document, registry);
        out.files = file_places(pipeline);
        return out;
    };
    const auto warnings = warnings_of(pipeline);
    if (json) return print_json(verbose ? to_json(values()) : to_json(warnings)), exit_code::done;
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

int graph(const PipelineArguments& arguments, const std::string& format, Registry& registry) {
    const auto pipeline = arguments.read_or_complain(registry);
    if (!pipeline) return exit_code::usage;
    print(format == "svg" ? to_svg(*pipeline, registry) : to_dot(*pipeline, registry));
    return exit_code::done;
}

}  // namespace

Verb::Work run_verb(CLI::App& verb, Program& program) {
    const auto arguments = std::make_shared<RunArguments>();
    program.pipeline.declare(verb);
    arguments->declare(verb);
    return [=, &program] { return run(program.pipeline, *arguments, program.registry); };
}

Verb::Work check_verb(CLI::App& verb, Program& program) {
    struct CheckOptions {
        bool json = false, verbose = false, open = false;
    };
    const auto options = std::make_shared<CheckOptions>();
    program.pipeline.declare(verb);
    verb.add_flag("--json", options->json,
                  "Print problems as JSON; with --verbose, print the values if there are no "
                  "problems");
    verb.add_flag("-v,--verbose", options->verbose,
                  "Show each value of the pipeline and its source, and where the files lie");
    verb.add_flag("--template", options->open,
                  "Let params have no value, as those of a template that shots extend");
    return [=, &program] {
        return check(program.pipeline, options->json, options->verbose, options->open,
                     program.registry);
    };
}

Verb::Work plan_verb(CLI::App& verb, Program& program) {
    const auto arguments = std::make_shared<RunArguments>();
    const auto json = std::make_shared<bool>(false);
    program.pipeline.declare(verb);
    arguments->declare(verb);
    verb.add_flag("--json", *json, "Print as JSON");
    return [=, &program] { return plan(program.pipeline, *arguments, *json, program.registry); };
}

Verb::Work graph_verb(CLI::App& verb, Program& program) {
    const auto format = std::make_shared<std::string>("dot");
    program.pipeline.declare(verb);
    verb.add_option("--format", *format, "Format of the picture")
        ->check(CLI::IsMember({"dot", "svg"}))
        ->capture_default_str();
    return [=, &program] { return graph(program.pipeline, *format, program.registry); };
}

}  // namespace fluidcarve
