#include "tests/fuzz/call.h"

#include "tests/support/scratch.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <chrono>
#include <cstdlib>
#include <sstream>
#include <thread>

namespace fuzz {
namespace {

using Clock = std::chrono::steady_clock;

/// The most address space of a call: what trusts a length in a file fails, and the machine lives
/// on.
constexpr rlim_t space = rlim_t{6} << 30;

[[noreturn]] void become(std::vector<char*> words, const std::string& folder) {
    const int in = open("/dev/null", O_RDWR),
              errors = open((folder + "/stderr.txt").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    dup2(in, STDIN_FILENO);
    dup2(in, STDOUT_FILENO);
    dup2(errors, STDERR_FILENO);
    // AddressSanitizer's shadow memory takes terabytes.
    if (const rlimit limit{space, space}; !sanitized) setrlimit(RLIMIT_AS, &limit);
    const rlimit no_core{0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
    setenv("FLUIDCARVE_NO_CACHE", "1", 1);
    setenv("FLUIDCARVE_MEMORY", "64M", 1);
    setenv("FLUIDCARVE_THREADS", "2", 1);
    // What a sanitizer finds ends the call by a signal: its exit code would be that of a failed
    // node.
    setenv("ASAN_OPTIONS", "abort_on_error=1", 1);
    setenv("UBSAN_OPTIONS", "abort_on_error=1", 1);
    if (chdir(folder.c_str()) == 0) execv(words[0], words.data());
    _exit(127);
}

}  // namespace

Ended call(const std::vector<std::string>& words, const std::string& folder, double most) {
    std::vector<char*> arguments;
    for (const auto& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    const auto begin = Clock::now();
    const auto seconds = [&] {
        return std::chrono::duration<double>(Clock::now() - begin).count();
    };
    const auto child = fork();
    if (child == 0) become(arguments, folder);
    Ended out;
    int status = 0;
    while (waitpid(child, &status, WNOHANG) == 0) {
        if (seconds() > most && !out.hung) {
            out.hung = true;
            kill(child, SIGKILL);
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    out.seconds = seconds();
    out.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    out.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    out.errors = Scratch::read(folder + "/stderr.txt");
    return out;
}

std::string fault_of(const Ended& ended) {
    if (ended.hung) return "hangs";
    if (ended.signal) return fmt::format("crashes with signal {}", ended.signal);
    if (ended.errors.find("This is a fault of fluidcarve itself") != std::string::npos)
        return "calls it a fault of its own: " + ended.errors;
    if (ended.code == 0 || ended.code == 2 || ended.code == 3) return {};
    bool failed = false;
    std::istringstream lines(ended.errors);
    for (std::string line; ended.code == 1 && std::getline(lines, line);) {
        if (!line.starts_with("failed: ")) continue;
        if (line.find(".read)") != std::string::npos ||
            line.find("(rig.curve)") != std::string::npos)
            return "a reader's failure has exit code 1: " + line;
        if (line.find("bad_alloc") != std::string::npos)
            return "asks for more memory than there is: " + line;
        failed = true;
    }
    return failed ? "" : fmt::format("ends with exit code {}", ended.code);
}

}  // namespace fuzz
