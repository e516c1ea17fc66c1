#pragma once

#include "graph/types/registry.h"
#include "tools/verbs/arguments.h"

#include <CLI/CLI.hpp>

#include <functional>
#include <string>
#include <vector>

namespace fluidcarve {

/// What the verbs of a command line share.
struct Program {
    CLI::App& app;
    Registry& registry;
    PipelineArguments& pipeline;
    std::vector<std::string> words;  ///< of the command line
};

/// A verb of the program.
struct Verb {
    /// What it does, once the command line is read. @return an exit code
    using Work = std::function<int()>;

    const char* name;
    const char* doc;
    Work (*declare)(CLI::App& verb, Program& program);  ///< declares its options
};

}  // namespace fluidcarve
