#pragma once

#include <string>
#include <vector>

namespace fluidcarve {

/// A word of a shell's command, in quotes if it needs them. Of other characters than those of ASCII
/// it needs bash or zsh.
std::string shell_word(const std::string& word);

/// Words as one command.
std::string shell_line(const std::vector<std::string>& words);

}  // namespace fluidcarve
