#include "runtime/tell/uncaught.h"

#include "carve/base/failure.h"
#include "runtime/tell/exit_codes.h"

#include <fmt/format.h>

#include <sys/resource.h>
#include <unistd.h>
#include <algorithm>
#include <cstring>
#include <latch>
#include <new>
#include <string_view>
#include <system_error>
#include <thread>
#include <vector>

/// Of jemalloc, where the program has it.
extern "C" [[gnu::weak]] int mallctl(const char* name, void* old, std::size_t* old_size,
                                     void* wanted, std::size_t wanted_size);

namespace fluidcarve {
namespace {

/// Writes without stdio, which may no longer work, or not yet.
void tell_at_last(std::string_view text) {
    [[maybe_unused]] const auto written = write(STDERR_FILENO, text.data(), text.size());
}

constexpr auto no_thread =
    "the system starts no more threads; raise its limit (ulimit -u), or give a smaller --threads";

/// Whether the system refused a thread. TBB says so by a std::runtime_error.
bool lacks_threads(const std::exception& error) {
    const auto* const of_system = dynamic_cast<const std::system_error*>(&error);
    return (of_system && of_system->code() == std::errc::resource_unavailable_try_again) ||
           std::strstr(error.what(), "pthread_create") != nullptr;
}

void require_limit(int which, rlim_t least, std::string_view fault) {
    rlimit limit{};
    if (getrlimit(which, &limit) != 0 || limit.rlim_cur >= least) return;
    tell_at_last(fault);
    _exit(exit_code::node_failed);
}

/// Lets jemalloc make the arenas of a number of threads. Without memory for its arena, a thread
/// crashes in jemalloc 5.3 at its first allocation.
/// @throws std::bad_alloc
void reserve_arenas(unsigned count) {
    if (!mallctl) return;
    unsigned own = 0, all = 0;
    auto size = sizeof own;
    if (mallctl("thread.arena", &own, &size, nullptr, 0) != 0 ||
        mallctl("arenas.narenas", &all, &size, nullptr, 0) != 0)
        return;
    bool made = true;
    for (unsigned n = 0; n < std::min(all, count) && made; ++n)
        made = mallctl("thread.arena", nullptr, nullptr, &n, sizeof n) == 0;
    mallctl("thread.arena", nullptr, nullptr, &own, sizeof own);
    if (!made) throw std::bad_alloc();
}

}  // namespace

std::string uncaught_text(const std::exception* error) {
    if (dynamic_cast<const std::bad_alloc*>(error))
        return "failed: out of memory; give it smaller volumes, or more memory\n";
    if (error && lacks_threads(*error)) return fmt::format("failed: {}\n", no_thread);
    return fmt::format(
        "failed: {}\nThis is a fault of fluidcarve itself; please report it with the command and "
        "the pipeline.\n",
        error ? error->what() : "an exception of unknown type");
}

void end_without_signal() {
    std::set_terminate([] {
        try {
            if (const auto error = std::current_exception()) std::rethrow_exception(error);
            tell_at_last(uncaught_text(nullptr));
        } catch (const std::exception& error) {
            tell_at_last(uncaught_text(&error));
        } catch (...) {
            tell_at_last(uncaught_text(nullptr));
        }
        _exit(exit_code::node_failed);
    });
}

void require_address_space() {
#if !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)  // their shadow memory takes terabytes
    constexpr rlim_t mib = rlim_t{1} << 20;
    require_limit(RLIMIT_AS, 256 * mib,
                  "failed: fluidcarve needs 256 MiB of address space at least; raise the limit "
                  "(ulimit -v)\n");
    require_limit(
        RLIMIT_STACK, mib,
        "failed: fluidcarve needs a stack of 1 MiB at least; raise the limit (ulimit -s)\n");
#endif
}

void require_threads(int count) {
    constexpr unsigned others = 3;  // the main thread, that of signals, that of the status
    reserve_arenas(static_cast<unsigned>(count) + others);
    std::latch all(1);
    std::vector<std::thread> threads;
    bool granted = true;
    try {
        while (threads.size() < static_cast<std::size_t>(count))
            threads.emplace_back([&] { all.wait(); });
    } catch (const std::system_error&) {
        granted = false;
    }
    all.count_down();
    for (auto& thread : threads) thread.join();
    if (!granted) throw Failure(no_thread);
}

}  // namespace fluidcarve
