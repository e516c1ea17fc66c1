#include "runtime/run/interrupt.h"

#include "formats/file/output_file.h"
#include "runtime/tell/exit_codes.h"
#include "runtime/tell/outcome.h"

#include <pthread.h>
#include <unistd.h>
#include <array>
#include <cerrno>
#include <csignal>
#include <utility>

namespace fluidcarve {
namespace {

constexpr std::array errors{SIGPIPE, SIGXFSZ};  ///< the failing call reports them instead

std::atomic<pthread_t> watcher;

sigset_t stop_signals() {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGINT);
    sigaddset(&set, SIGTERM);
    struct sigaction hang_up {};
    if (sigaction(SIGHUP, nullptr, &hang_up) == 0 && hang_up.sa_handler != SIG_IGN)
        sigaddset(&set, SIGHUP);
    return set;
}

}  // namespace

Interrupt::Interrupt(std::string last_words, int grace_ms)
    : last_words_(last_words.empty() ? std::string() : "\n" + std::move(last_words) + "\n"),
      grace_ms_(grace_ms) {
    for (const int number : errors) std::signal(number, SIG_IGN);
    // Signals are blocked in this thread, and so in all threads that it starts later. Only the
    // watcher waits for them. It uses no descriptor, since none may be left. A thread that existed
    // before forwards the signals that it gets.
    const auto set = stop_signals();
    pthread_sigmask(SIG_BLOCK, &set, nullptr);
    thread_ = std::thread([this] { watch(); });
    watcher = thread_.native_handle();
    for (const int number : {SIGINT, SIGTERM, SIGHUP})
        if (sigismember(&set, number) == 1) std::signal(number, &Interrupt::forward);
}

void Interrupt::forward(int number) {
    const int error = errno;
    pthread_kill(watcher, number);
    errno = error;
}

Interrupt::~Interrupt() {
    const auto set = stop_signals();
    for (const int number : {SIGINT, SIGTERM, SIGHUP})
        if (sigismember(&set, number) == 1) std::signal(number, SIG_DFL);
    ended_ = true;
    pthread_kill(thread_.native_handle(), SIGINT);
    thread_.join();
    pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
    for (const int number : errors) std::signal(number, SIG_DFL);
}

void Interrupt::watch() {
    constexpr int thousand = 1000;
    const auto set = stop_signals();
    const timespec grace{grace_ms_ / thousand, grace_ms_ % thousand * thousand * thousand};
    while (true) {
        const int number = sigtimedwait(&set, nullptr, asked_ ? &grace : nullptr);
        if (ended_) return;
        if (number < 0 && errno == EINTR) continue;
        if (asked_) {
            OutputFile::remove_unfinished();
            // Bypasses stdio: another thread may hold its lock for ever.
            [[maybe_unused]] const auto told =
                write(STDERR_FILENO, last_words_.data(), last_words_.size());
            _exit(exit_code::interrupted);
        }
        asked_ = true;
    }
}

std::string last_words(bool quiet, bool kept) {
    return quiet ? std::string() : interrupted_text(kept);
}

}  // namespace fluidcarve
