#pragma once

#include <string>

namespace CLI {
class App;
}

namespace fluidcarve {

/// The manual page of a program with verbs (roff), made of what its command line declares.
std::string man_page(const CLI::App& app, const std::string& version);

/// A script for bash or zsh that completes verbs, options, their choices, and files elsewhere.
/// @param shell  "bash" or "zsh"
std::string completion(const CLI::App& app, const std::string& shell);

}  // namespace fluidcarve
