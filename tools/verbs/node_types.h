#pragma once

#include "tools/verbs/verb.h"

namespace fluidcarve {

/// The verbs `nodes` and `schema`, which tell what pipelines may hold.
Verb::Work nodes_verb(CLI::App& verb, Program& program);
Verb::Work schema_verb(CLI::App& verb, Program& program);

}  // namespace fluidcarve
