#include "runtime/tell/terminal.h"

#include <unistd.h>
#include <cstdio>
#include <cstdlib>
#include <utility>

namespace fluidcarve {

bool coloured_terminal() {
    const char* const no_color = std::getenv("NO_COLOR");
    return isatty(STDERR_FILENO) != 0 && (!no_color || *no_color == '\0');
}

// Not fmt::print: it throws if stderr is a file on a full disk.
void tell(const std::string& text) {
    std::string line = text + "\n";
    if (coloured_terminal())
        for (const auto& [word, colour] : {std::pair<std::string, const char*>("failed:", "\033[1;31m"), {"warning:", "\033[33m"}, {"done:", "\033[32m"}})
            if (text.starts_with(word)) line = colour + word + "\033[0m" + line.substr(word.size());
    std::fputs(line.c_str(), stderr);
}

}  // namespace fluidcarve
