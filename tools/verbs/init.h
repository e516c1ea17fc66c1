#pragma once

#include "graph/types/registry.h"

#include <string>

namespace CLI {
class App;
}  // namespace CLI

namespace fluidcarve {

/// Arguments of the verb `init`.
struct InitArguments {
    std::string files;
    std::string out;  ///< empty: stdout

    void declare(CLI::App& verb);
};

/// The verb `init`: looks at files and writes the commented pipeline for them. @return an exit code
int init_pipeline(const InitArguments& arguments, const Registry& registry);

}  // namespace fluidcarve
