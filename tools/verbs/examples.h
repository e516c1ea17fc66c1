#pragma once

#include <CLI/CLI.hpp>

namespace fluidcarve {

/// Adds examples to the help of each verb and the manual page.
void add_examples(CLI::App& app);

}  // namespace fluidcarve
