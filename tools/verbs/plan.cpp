#include "tools/verbs/verbs.h"

#include "runtime/run/run.h"
#include "runtime/tell/exit_codes.h"
#include "tools/verbs/arguments.h"

#include <CLI/CLI.hpp>

#include <memory>

namespace fluidcarve {
namespace {

int plan(const PipelineArguments& arguments, RunArguments& run_arguments, bool json,
         Registry& registry) {
    const auto pipeline = arguments.read_or_complain(registry);
    if (!pipeline) return exit_code::usage;
    const auto request = run_arguments.read(*pipeline);
    return request ? plan_pipeline(*pipeline, registry, *request, json) : exit_code::usage;
}

}  // namespace

Verb::Work plan_verb(CLI::App& verb, Program& program) {
    const auto arguments = std::make_shared<RunArguments>();
    const auto json = std::make_shared<bool>(false);
    program.pipeline.declare(verb);
    arguments->declare(verb);
    verb.add_flag("--json", *json, "Print as JSON");
    return [=, &program] { return plan(program.pipeline, *arguments, *json, program.registry); };
}

}  // namespace fluidcarve
