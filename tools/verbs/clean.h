#pragma once

#include "tools/verbs/verb.h"

namespace fluidcarve {

/// The verbs `clean` and `status`, which look at a work folder.
Verb::Work clean_verb(CLI::App& verb, Program& program);
Verb::Work status_verb(CLI::App& verb, Program& program);

}  // namespace fluidcarve
