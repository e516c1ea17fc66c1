#pragma once

#include "runtime/jobs/engine.h"
#include "tools/verbs/arguments.h"

#include <string>
#include <vector>

namespace fluidcarve {

/// Arguments of the verb `farm`, besides those of `run`.
struct FarmArguments {
    std::string engine;
    std::size_t chunk = 0;
    double minutes = 0;
    std::string prefix;
    bool dry_run = false;
    bool json = false;
    bool no_chunk_extension = false;
    FarmRequest request;
    const CLI::Option* chunk_option = nullptr;
    const CLI::Option* minutes_option = nullptr;
    std::vector<const CLI::Option*> engine_options;  ///< those that only some engines take

    void declare(CLI::App& verb, PipelineArguments& pipeline, RunArguments& run);
};

/// The verb `farm`: makes a job of a run and hands it to an engine.
/// @param command  the words of the command line
/// @return an exit code
int farm(const FarmArguments& arguments, const PipelineArguments& pipeline, RunArguments& run,
         const std::vector<std::string>& command, Registry& registry);

}  // namespace fluidcarve
