#include "nodes/catalogue.h"
#include "runtime/run/run.h"
#include "runtime/verbs/commands.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <exception>

namespace {

/// Opens standard streams that were closed, so that no file of ours gets their number, and messages with it.
void open_standard_streams() {
    for (int number = STDIN_FILENO; number <= STDERR_FILENO; ++number)
        if (::fcntl(number, F_GETFD) == -1) static_cast<void>(::open("/dev/null", O_RDWR));
}

}  // namespace

int main(int argc, char** argv) {
    open_standard_streams();
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
