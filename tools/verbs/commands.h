#pragma once

#include "graph/types/registry.h"

namespace fluidcarve {

/// The program: parses the command line and runs the verb. Results go to stdout, everything else to
/// stderr.
/// @param registry  all built-in types; verbs add the types of plugins
/// @return an exit code
int run_command_line(int argc, const char* const* argv, Registry registry);

}  // namespace fluidcarve
