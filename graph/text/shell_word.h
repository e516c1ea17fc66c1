#pragma once

#include <string>
#include <vector>

namespace fluidcarve {

/// A word of a shell command, quoted if necessary. Control and non-ASCII characters need bash or
/// zsh.
std::string shell_word(const std::string& word);

/// Words as one command.
std::string shell_line(const std::vector<std::string>& words);

}  // namespace fluidcarve
