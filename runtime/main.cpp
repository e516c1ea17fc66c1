#include "nodes/catalogue.h"
#include "runtime/run/run.h"
#include "runtime/verbs/commands.h"

#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include <climits>
#include <cstdio>
#include <exception>

namespace {

/// Frames come and go, each in thousands of small pieces. Memory that one leaves is kept for the next: giving it back to the system and
/// asking for it again took a fifth of a run.
void keep_freed_memory() {
#if defined(__GLIBC__)
    mallopt(M_TRIM_THRESHOLD, INT_MAX);
    mallopt(M_MMAP_THRESHOLD, 32 << 20);
    mallopt(M_TOP_PAD, 16 << 20);
#endif
}

}  // namespace

int main(int argc, char** argv) {
    keep_freed_memory();
    int code = fluidcarve::exit_code::node_failed;
    try {
        code = fluidcarve::run_command_line(argc, argv, fluidcarve::builtin_registry());
    } catch (const std::exception& error) {
        std::fprintf(stderr, "failed: %s\nThis is a fault of fluidcarve itself; please report it with the command and the pipeline.\n", error.what());
    }
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
    std::fputs("failed: the results could not be written; is the disk full?\n", stderr);
    return code == fluidcarve::exit_code::done ? fluidcarve::exit_code::node_failed : code;
}
