#pragma once

#include "tools/verbs/arguments.h"
#include "tools/verbs/carve.h"
#include "tools/verbs/init.h"
#include "tools/verbs/shell.h"

#include <CLI/CLI.hpp>

namespace fluidcarve {

/// Adds examples to the help of each verb and the manual page.
void add_examples(CLI::App& app);

}  // namespace fluidcarve
