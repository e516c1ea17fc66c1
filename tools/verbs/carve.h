#pragma once

#include "graph/types/registry.h"
#include "tools/draft/request.h"
#include "tools/verbs/arguments.h"

#include <map>
#include <string>
#include <vector>

namespace CLI {
class App;
}  // namespace CLI

namespace fluidcarve {

/// Arguments of the verb `carve`.
struct CarveArguments {
    std::string files, count, out, seams, sheet;
    std::string axis = "x", solver;
    bool warp = false;  ///< instead of a solver
    std::vector<std::string> protect;
    /// Stated values of options that become parameters of nodes, by name; empty: as the draft has
    /// it.
    std::map<std::string, std::string> params;
    bool print_pipeline = false;
    RunArguments run;

    void declare(CLI::App& verb);
};

/// The verb `carve`: carves files in the box around them by the pipeline that `init` would write,
/// without a file of it.
/// @return an exit code
int carve_files(CarveArguments& arguments, const Registry& registry);

}  // namespace fluidcarve
