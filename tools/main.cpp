#include "nodes/catalogue.h"
#include "runtime/tell/exit_codes.h"
#include "runtime/tell/uncaught.h"
#include "tools/verbs/commands.h"

#include <fcntl.h>
#include <tbb/cache_aligned_allocator.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <exception>

namespace {

/// Opens standard streams that were closed, so that no file of ours gets their number, and messages
/// with it.
void open_standard_streams() {
    for (int number = STDIN_FILENO; number <= STDERR_FILENO; ++number)
        if (::fcntl(number, F_GETFD) == -1) static_cast<void>(::open("/dev/null", O_RDWR));
}

/// Lets TBB take its first memory, of each size that it needs to set itself up, where a refusal is
/// thrown. While it sets itself up, TBB of 2022 and later would wait for ever.
void warm_allocator() {
    tbb::cache_aligned_allocator<char> allocator;
    for (const std::size_t size : {1, 1 << 13, 1 << 16, 1 << 20})
        allocator.deallocate(allocator.allocate(size), size);
}

/// Runs before the libraries are initialised: some start threads and allocate then.
void begin() {
    fluidcarve::require_address_space();
    fluidcarve::end_without_signal();
}
[[gnu::section(".preinit_array"), gnu::used]] void (*const first)() = begin;

}  // namespace

int main(int argc, char** argv) {
    open_standard_streams();
    // Where the parent ignores it, the ends of our own children could not be waited for.
    std::signal(SIGCHLD, SIG_DFL);
    int code = fluidcarve::exit_code::node_failed;
    try {
        warm_allocator();
        code = fluidcarve::run_command_line(argc, argv, fluidcarve::builtin_registry());
    } catch (const std::exception& error) {
        std::fputs(fluidcarve::uncaught_text(&error).c_str(), stderr);
    }
    if (std::ferror(stdout) == 0 && std::fclose(stdout) == 0) return code;
    std::fputs("failed: the results could not be written; is the disk full?\n", stderr);
    return code == fluidcarve::exit_code::done ? fluidcarve::exit_code::node_failed : code;
}
