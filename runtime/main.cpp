#include "nodes/catalogue.h"
#include "runtime/run/run.h"
#include "runtime/verbs/commands.h"

#include <cstdio>

int main(int argc, char** argv) {
    const int code = fluidcarve::run_command_line(argc, argv, fluidcarve::builtin_registry());
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
    std::fputs("failed: the results could not be written; is the disk full?\n", stderr);
    return code == fluidcarve::exit_code::done ? fluidcarve::exit_code::node_failed : code;
}
