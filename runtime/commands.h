#pragma once

#include "graph/registry.h"

namespace fluidcarve {

/// The program: parses the command line and runs the verb. Results go to stdout, everything else to stderr.
/// @return an exit code
int run_command_line(int argc, const char* const* argv, const Registry& registry);

}  // namespace fluidcarve
