#include "runtime/run/interrupt.h"

#include "graph/output_file.h"
#include "runtime/tell/exit_codes.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/signalfd.h>
#include <unistd.h>
#include <array>
#include <csignal>
#include <cstdint>
#include <utility>

namespace fluidcarve {
namespace {

constexpr std::array errors{SIGPIPE, SIGXFSZ};  ///< what fails instead tells them

sigset_t stop_signals() {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGINT);
    sigaddset(&set, SIGTERM);
    struct sigaction hang_up {};
    if (sigaction(SIGHUP, nullptr, &hang_up) == 0 && hang_up.sa_handler != SIG_IGN) sigaddset(&set, SIGHUP);
    return set;
}

}  // namespace

Interrupt::Interrupt(std::string last_words, int grace_ms)
    : last_words_(last_words.empty() ? std::string() : "\n" + std::move(last_words) + "\n"), grace_ms_(grace_ms) {
    for (const int number : errors) std::signal(number, SIG_IGN);
    // Signals are blocked in this thread, and so in all threads that it starts later. Only the watcher reads them, through signalfd.
    const auto set = stop_signals();
    pthread_sigmask(SIG_BLOCK, &set, nullptr);
    signals_ = signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK);
    ended_ = eventfd(0, EFD_CLOEXEC);
    thread_ = std::thread([this] { watch(); });
}

Interrupt::~Interrupt() {
    const std::uint64_t one = 1;
    [[maybe_unused]] const auto written = write(ended_, &one, sizeof one);
    thread_.join();
    close(signals_);
    close(ended_);
    const auto set = stop_signals();
    pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
    for (const int number : errors) std::signal(number, SIG_DFL);
}

void Interrupt::watch() {
    pollfd fds[] = {{ended_, POLLIN, 0}, {signals_, POLLIN, 0}};
    int timeout = -1;
    while (true) {
        const int events = poll(fds, 2, timeout);
        if (fds[0].revents != 0) return;
        if (events == 0 || asked_) {
            OutputFile::remove_unfinished();
            // Past stdio: another thread may hold its lock for ever.
            [[maybe_unused]] const auto told = write(STDERR_FILENO, last_words_.data(), last_words_.size());
            _exit(exit_code::interrupted);
        }
        signalfd_siginfo info;
        if (read(signals_, &info, sizeof info) == sizeof info) {
            asked_ = true;
            timeout = grace_ms_;
        }
    }
}

}  // namespace fluidcarve
