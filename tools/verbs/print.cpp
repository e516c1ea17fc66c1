#include "tools/verbs/print.h"

#include "carve/base/one_line.h"
#include "graph/text/json_text.h"
#include "runtime/tell/terminal.h"

#include <cstdio>

namespace fluidcarve {
namespace {

/// Not fmt::print: it throws if the output is a file on a full disk.
void put(const std::string& text, std::FILE* to) {
    const auto shown = printable(text);
    std::fwrite(shown.data(), 1, shown.size(), to);
}

}  // namespace

void print(const std::string& text) { put(text, stdout); }
void print_json(const nlohmann::ordered_json& json) { print(json_text(json, 2) + "\n"); }
void complain(const std::string& text) {
    if (told_as_events()) return tell_event(text, "failure");
    put(text, stderr);
}

int end_with(const std::string& message, int code) { return complain(message + "\n"), code; }
int end_with(const Problems& problems) { return complain(to_text(problems)), exit_code::usage; }

}  // namespace fluidcarve
