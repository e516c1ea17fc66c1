#include "tools/verbs/verbs.h"

#include "carve/base/words.h"
#include "graph/document.h"
#include "graph/pipeline.h"
#include "graph/views/file_places.h"
#include "graph/views/value_sources.h"
#include "runtime/tell/exit_codes.h"
#include "tools/verbs/arguments.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <memory>

namespace fluidcarve {
namespace {

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

}  // namespace

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

}  // namespace fluidcarve
