#include "tools/verbs/run.h"

#include "graph/provenance.h"
#include "graph/views/value_sources.h"
#include "runtime/run/interrupt.h"
#include "runtime/run/run.h"
#include "runtime/tell/exit_codes.h"
#include "tools/verbs/verbs.h"

#include <CLI/CLI.hpp>

#include <memory>
#include <string>
#include <utility>

namespace fluidcarve {

int run_built(Pipeline pipeline, const Document& document, RunArguments& arguments,
              const Registry& registry) {
    state_provenance(pipeline, document, registry);
    auto request = arguments.read(pipeline);
    if (!request) return exit_code::usage;
    request->sources = value_sources_of(document, registry);
    const Interrupt interrupt(last_words(request->quiet, request->options.cache));
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

}  // namespace

Verb::Work run_verb(CLI::App& verb, Program& program) {
    const auto arguments = std::make_shared<RunArguments>();
    program.pipeline.declare(verb);
    arguments->declare(verb);
    return [=, &program] { return run(program.pipeline, *arguments, program.registry); };
}

}  // namespace fluidcarve
