#include "tools/reading/child_call.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstring>
#include <exception>
#include <new>
#include <system_error>
#include <thread>

namespace fluidcarve {
namespace {

constexpr char returned = 'r', threw = 't';

void write_all(int file, const std::string& text) {
    for (std::size_t done = 0; done < text.size();) {
        const auto wrote = write(file, text.data() + done, text.size() - done);
        if (wrote < 0 && errno != EINTR) return;
        if (wrote > 0) done += static_cast<std::size_t>(wrote);
    }
}

void confine(std::uint64_t memory, double seconds) {
    // The child must not survive a killed parent, nor loop forever.
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    const rlimit time{
        static_cast<rlim_t>(seconds * std::max(1U, std::thread::hardware_concurrency())) + 1,
        RLIM_INFINITY};
    setrlimit(RLIMIT_CPU, &time);
    const rlimit no_core{0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
#if !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)  // sanitizers' shadow memory takes terabytes
    const rlimit space{memory, memory};
    setrlimit(RLIMIT_AS, &space);
#else
    static_cast<void>(memory);
#endif
    const int nowhere = open("/dev/null", O_RDWR);
    for (const int file : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nowhere, file);
}

[[noreturn]] void run_child(const std::function<std::string()>& call, std::uint64_t memory,
                            double seconds, int out) {
    confine(memory, seconds);
    std::string answer;
    try {
        answer = returned + call();
    } catch (const std::bad_alloc&) {
        answer = threw + std::string("it needs more memory than is allowed");
    } catch (const std::exception& error) {
        answer = threw + std::string(error.what());
    }
    write_all(out, answer);
    _exit(0);
}

/// Reads everything that the child writes. @return false if the time is over before
bool read_all(int in, double seconds, std::string& text) {
    using Clock = std::chrono::steady_clock;
    const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                        std::chrono::duration<double>(seconds));
    std::array<char, 65536> buffer;
    while (true) {
        const auto left =
            std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
        if (left <= 0) return false;
        pollfd ready{in, POLLIN, 0};
        if (poll(&ready, 1, static_cast<int>(left)) <= 0) continue;
        const auto got = read(in, buffer.data(), buffer.size());
        if (got == 0) return true;
        if (got > 0) text.append(buffer.data(), static_cast<std::size_t>(got));
        else if (errno != EINTR) return true;
    }
}

}  // namespace

ChildResult call_in_child(const std::function<std::string()>& call, std::uint64_t memory,
                          double seconds) {
    std::array<int, 2> channel{};
    if (pipe2(channel.data(), O_CLOEXEC) != 0)
        throw std::system_error(errno, std::generic_category(), "pipe");
    const auto child = fork();
    if (child < 0) throw std::system_error(errno, std::generic_category(), "fork");
    if (child == 0) run_child(call, memory, seconds, channel[1]);
    close(channel[1]);
    std::string answer;
    const bool in_time = read_all(channel[0], seconds, answer);
    close(channel[0]);
    if (!in_time) kill(child, SIGKILL);
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {}
    if (!in_time) return {ChildResult::End::too_slow, {}};
    if (WIFSIGNALED(status)) return {ChildResult::End::crashed, strsignal(WTERMSIG(status))};
    if (answer.empty() || (answer[0] != returned && answer[0] != threw))
        return {ChildResult::End::crashed, "no answer"};
    return {answer[0] == returned ? ChildResult::End::returned : ChildResult::End::threw,
            answer.substr(1)};
}

}  // namespace fluidcarve
