#pragma once

#include "tools/verbs/verb.h"

namespace fluidcarve {

/// The verbs `run`, `check`, `plan` and `graph`, which take a pipeline.
Verb::Work run_verb(CLI::App& verb, Program& program);
Verb::Work check_verb(CLI::App& verb, Program& program);
Verb::Work plan_verb(CLI::App& verb, Program& program);
Verb::Work graph_verb(CLI::App& verb, Program& program);

}  // namespace fluidcarve
