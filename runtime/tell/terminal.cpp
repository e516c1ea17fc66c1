#include "runtime/tell/terminal.h"

#include "graph/text/json_text.h"

#include <nlohmann/json.hpp>

#include <unistd.h>
#include <cstdio>
#include <cstdlib>
#include <utility>

namespace fluidcarve {

bool coloured_terminal() {
    const char* const no_color = std::getenv("NO_COLOR");
    return isatty(STDERR_FILENO) != 0 && (!no_color || *no_color == '\0');
}

namespace {
bool as_events = false;
}

void tell_as_events() { as_events = true; }
bool told_as_events() { return as_events; }

void tell_event(const std::string& text, const std::string& otherwise) {
    auto kind = otherwise;
    auto rest = text;
    for (const auto& [word, name] : {std::pair<std::string, std::string>("failed: ", "failure"),
                                     {"warning: ", "warning"},
                                     {"done: ", "done"}})
        if (text.starts_with(word)) {
            kind = name;
            rest = text.substr(word.size());
        }
    while (rest.ends_with('\n')) rest.pop_back();
    const auto line = json_text(nlohmann::ordered_json{{"event", kind}, {"text", rest}}) + "\n";
    std::fputs(line.c_str(), stderr);
}

// Not fmt::print: it throws if stderr is a file on a full disk.
void tell(const std::string& text) {
    if (as_events) return tell_event(text, "result");
    std::string line = text + "\n";
    if (coloured_terminal())
        for (const auto& [word, colour] :
             {std::pair<std::string, const char*>("failed:", "\033[1;31m"),
              {"warning:", "\033[33m"},
              {"done:", "\033[32m"}})
            if (text.starts_with(word)) line = colour + word + "\033[0m" + line.substr(word.size());
    std::fputs(line.c_str(), stderr);
}

}  // namespace fluidcarve
