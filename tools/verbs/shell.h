#pragma once

#include <string>

namespace CLI {
class App;
}

namespace fluidcarve {

/// The manual page of a program with verbs, in roff, generated from its command line.
std::string man_page(const CLI::App& app, const std::string& version);

/// A script that completes verbs, options and their choices, and file names for all other
/// arguments.
/// @param shell  "bash", "zsh" or "fish"
std::string completion(const CLI::App& app, const std::string& shell);

}  // namespace fluidcarve
