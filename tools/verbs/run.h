#pragma once

#include "graph/document.h"
#include "graph/pipeline.h"
#include "tools/verbs/arguments.h"
#include "tools/verbs/verb.h"

namespace fluidcarve {

/// Runs a checked pipeline as the arguments say, until it ends or the user interrupts it.
/// @param document  from which the pipeline was built
/// @return the exit code
int run_built(Pipeline pipeline, const Document& document, RunArguments& arguments,
              const Registry& registry);

/// The verbs `run`, `check`, `plan` and `graph`, which take a pipeline.
Verb::Work run_verb(CLI::App& verb, Program& program);
Verb::Work check_verb(CLI::App& verb, Program& program);
Verb::Work plan_verb(CLI::App& verb, Program& program);
Verb::Work graph_verb(CLI::App& verb, Program& program);

}  // namespace fluidcarve
