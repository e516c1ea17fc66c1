#pragma once

#include "tools/verbs/verb.h"

namespace fluidcarve {

// The verbs of the program. Each declares its options and returns its work.

Verb::Work run_verb(CLI::App& verb, Program& program);
Verb::Work check_verb(CLI::App& verb, Program& program);
Verb::Work plan_verb(CLI::App& verb, Program& program);
Verb::Work farm_verb(CLI::App& verb, Program& program);
Verb::Work view_verb(CLI::App& verb, Program& program);
Verb::Work status_verb(CLI::App& verb, Program& program);
Verb::Work clean_verb(CLI::App& verb, Program& program);
Verb::Work nodes_verb(CLI::App& verb, Program& program);
Verb::Work schema_verb(CLI::App& verb, Program& program);
Verb::Work wedge_verb(CLI::App& verb, Program& program);
Verb::Work carve_verb(CLI::App& verb, Program& program);
Verb::Work init_verb(CLI::App& verb, Program& program);
Verb::Work new_node_verb(CLI::App& verb, Program& program);
Verb::Work graph_verb(CLI::App& verb, Program& program);
Verb::Work inspect_verb(CLI::App& verb, Program& program);
Verb::Work explain_verb(CLI::App& verb, Program& program);
Verb::Work diff_verb(CLI::App& verb, Program& program);
Verb::Work man_verb(CLI::App& verb, Program& program);
Verb::Work completion_verb(CLI::App& verb, Program& program);

}  // namespace fluidcarve
