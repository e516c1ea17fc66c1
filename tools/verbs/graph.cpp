#include "tools/verbs/verbs.h"

#include "graph/views/drawing.h"
#include "runtime/tell/exit_codes.h"
#include "tools/verbs/arguments.h"

#include <CLI/CLI.hpp>

#include <memory>
#include <string>

namespace fluidcarve {
namespace {

int graph(const PipelineArguments& arguments, const std::string& format, Registry& registry) {
    const auto pipeline = arguments.read_or_complain(registry);
    if (!pipeline) return exit_code::usage;
    print(format == "svg" ? to_svg(*pipeline, registry) : to_dot(*pipeline, registry));
    return exit_code::done;
}

}  // namespace

Verb::Work graph_verb(CLI::App& verb, Program& program) {
    const auto format = std::make_shared<std::string>("dot");
    program.pipeline.declare(verb);
    verb.add_option("--format", *format, "Format of the picture")
        ->check(CLI::IsMember({"dot", "svg"}))
        ->capture_default_str();
    return [=, &program] { return graph(program.pipeline, *format, program.registry); };
}

}  // namespace fluidcarve
