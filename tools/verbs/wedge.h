#pragma once

#include "tools/verbs/arguments.h"

#include <string>
#include <vector>

namespace fluidcarve {

/// Arguments of the verb `wedge`, beside those of the pipeline.
struct WedgeArguments {
    std::vector<std::string> over;  ///< of --over: `TARGET=VALUE,VALUE`
    std::string out = "wedge";      ///< the folder of all results
    RunArguments run;

    void declare(CLI::App& verb);
};

/// The verb `wedge`: runs a pipeline with all combinations of values, each into a folder of its
/// own, and shows the results side by side.
/// @return an exit code: the first that is not 0, if a run failed
int wedge_pipeline(const PipelineArguments& pipeline, WedgeArguments& arguments,
                   Registry& registry);

}  // namespace fluidcarve
