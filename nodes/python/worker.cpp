#include "nodes/python/worker.h"

#include "carve/base/failure.h"
#include "carve/base/words.h"
#include "formats/file/module.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <limits>
#include <utility>

namespace fluidcarve {
namespace {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

/// The program that the process runs first. It finds the package by its first argument, never in
/// the current folder.
constexpr auto start_text =
    "import sys\n"
    "sys.path[:] = [sys.argv[1]] + [each for each in sys.path if each]\n"
    "if sys.version_info < (3, 9): sys.exit('fluidcarve needs Python 3.9 or newer; this is ' + "
    "sys.version.split()[0])\n"
    "from fluidcarve.worker import main\n"
    "main()\n";

/// The descriptors that the process gets besides the standard ones. Their order is that of SOCKET,
/// GIVEN, ANSWERED and LIFE in python/fluidcarve/worker.py.
constexpr int first_descriptor = 3, descriptor_count = 4;
constexpr std::size_t most_printed = 1000, most_log = std::size_t{1} << 20;
/// The process ends itself when its time is over, and tells where it was. If it can't, this
/// program ends it after these further seconds.
constexpr double grace = 2;
/// Libraries take some memory before a script asks for any.
constexpr std::uint64_t least_memory = std::uint64_t{1} << 30;
constexpr int pause_ms = 50, most_going_ms = 2000;

/// Variables added to the process's environment, unless this program's environment has them: they
/// make glibc keep the memory of arrays for the next frame. Fresh memory from the system takes
/// twice as long to compute in.
constexpr std::array<std::pair<const char*, const char*>, 2> memory_settings{
    {{"MALLOC_MMAP_MAX_", "0"}, {"MALLOC_TRIM_THRESHOLD_", "4611686018427387904"}}};

struct FileActions {
    posix_spawn_file_actions_t actions{};
    FileActions() { posix_spawn_file_actions_init(&actions); }
    ~FileActions() { posix_spawn_file_actions_destroy(&actions); }
};
/// A group of its own, so that Ctrl-C reaches this program alone, which ends the group. Signals as
/// in a new process.
struct SpawnAttributes {
    posix_spawnattr_t attributes{};
    SpawnAttributes() {
        posix_spawnattr_init(&attributes);
        sigset_t none, all;
        sigemptyset(&none);
        sigfillset(&all);
        posix_spawnattr_setflags(
            &attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
        posix_spawnattr_setsigmask(&attributes, &none);
        posix_spawnattr_setsigdefault(&attributes, &all);
    }
    ~SpawnAttributes() { posix_spawnattr_destroy(&attributes); }
};
/// The words and the environment with which the process starts.
struct CommandLine {
    std::vector<std::string> words, settings;
    std::vector<char*> arguments, environment;

    CommandLine(const std::string& interpreter, const std::string& package)
        : words{interpreter, "-c", start_text, package} {
        for (const auto& [name, value] : memory_settings)
            if (!std::getenv(name)) settings.push_back(fmt::format("{}={}", name, value));
        for (auto& word : words) arguments.push_back(word.data());
        for (auto** each = environ; *each; ++each) environment.push_back(*each);
        for (auto& setting : settings) environment.push_back(setting.data());
        arguments.push_back(nullptr);
        environment.push_back(nullptr);
    }
    CommandLine(const CommandLine&) = delete;
    CommandLine& operator=(const CommandLine&) = delete;
};

[[noreturn]] void refuse_start(const std::string& interpreter, int error) {
    throw Failure(
        fmt::format("cannot start the Python '{}': {}; name one by `python`, or in the environment "
                    "variable FLUIDCARVE_PYTHON",
                    interpreter, std::strerror(error)));
}

void close_if_open(int& file) {
    if (file >= 0) close(file);
    file = -1;
}

/// Descriptors that are closed at the end of a block.
struct Descriptors {
    std::vector<int> files;
    Descriptors() = default;
    Descriptors(const Descriptors&) = delete;
    Descriptors& operator=(const Descriptors&) = delete;
    ~Descriptors() {
        for (int& file : files) close_if_open(file);
    }
};

/// Number of bytes that the process has printed.
std::size_t size_of_log(int log) {
    struct stat now {};
    return fstat(log, &now) == 0 ? static_cast<std::size_t>(now.st_size) : 0;
}

/// Reads a part of what the process has printed.
/// @param begin, size  bytes
std::string read_log(int log, std::size_t begin, std::size_t size) {
    std::string out(size, '\0');
    const auto got = pread(log, out.data(), out.size(), static_cast<off_t>(begin));
    out.resize(static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    return out;
}

/// The end of what the process has printed: a dump of the stack comes last.
std::string end_of(int log) {
    constexpr std::size_t most_dump = 16 << 10;
    const auto all = size_of_log(log), size = std::min(all, most_dump);
    return read_log(log, all - size, size);
}

/// The place in a dump of Python's faulthandler: the first in the script's folder, else the first.
/// Empty: there is none.
std::string place_in(const std::string& dump, const std::string& script) {
    const auto folder = std::filesystem::path(script).parent_path().string();
    std::string first;
    for (std::size_t at = 0; (at = dump.find("File \"", at)) != std::string::npos;) {
        const auto begin = at + 6, end = dump.find("\", line ", begin);
        if (end == std::string::npos) break;
        const auto number = end + 8, after = dump.find_first_not_of("0123456789", number);
        const auto file = dump.substr(begin, end - begin);
        auto place = fmt::format("{}:{}", file, dump.substr(number, after - number));
        if (file.starts_with(folder)) return place;
        if (first.empty()) first = std::move(place);
        at = end;
    }
    return first;
}

}  // namespace

Worker::Worker(const std::string& interpreter, const std::string& script,
               const WorkerLimits& limits, const WorkerHost& host)
    : interpreter_(interpreter), script_(script) {
    try {
        start();
        call({{"open", script}}, limits, host);
    } catch (...) {
        // No destructor runs if the constructor throws.
        end();
        close_if_open(log_);
        throw;
    }
}

Worker::~Worker() {
    end();
    close_if_open(log_);
}

void Worker::start() {
    const auto package = shared_folder("python");
    std::array<int, 2> sockets{}, life{};
    Descriptors handed_over;
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets.data()) != 0)
        refuse_start(interpreter_, errno);
    socket_ = sockets[0];
    handed_over.files.push_back(sockets[1]);
    if (pipe2(life.data(), O_CLOEXEC) != 0) refuse_start(interpreter_, errno);
    life_ = life[1];
    handed_over.files.push_back(life[0]);
    log_ = memfd_create("fluidcarve log", MFD_CLOEXEC);
    if (log_ < 0) refuse_start(interpreter_, errno);
    fcntl(log_, F_SETFL, O_APPEND);

    // Descriptors above those that the process gets, so that none is overwritten before it is
    // handed over.
    Descriptors above;
    for (const int file : {sockets[1], given.descriptor(), answered.descriptor(), life[0], log_})
        above.files.push_back(fcntl(file, F_DUPFD_CLOEXEC, first_descriptor + descriptor_count));
    FileActions files;
    posix_spawn_file_actions_addopen(&files.actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    for (int n = 0; n < descriptor_count; ++n)
        posix_spawn_file_actions_adddup2(&files.actions, above.files[static_cast<std::size_t>(n)],
                                         first_descriptor + n);
    for (const int file : {STDOUT_FILENO, STDERR_FILENO})
        posix_spawn_file_actions_adddup2(&files.actions, above.files.back(), file);

    SpawnAttributes how;
    CommandLine line(interpreter_, package);
    const int error = posix_spawnp(&process_, interpreter_.c_str(), &files.actions, &how.attributes,
                                   line.arguments.data(), line.environment.data());
    if (error == 0) return;
    process_ = -1;
    refuse_start(interpreter_, error);
}

void Worker::send(const std::string& line) {
    for (std::size_t done = 0; done < line.size();) {
        const auto sent = ::send(socket_, line.data() + done, line.size() - done, MSG_NOSIGNAL);
        if (sent < 0 && errno != EINTR) return;  // the missing answer is reported later
        if (sent > 0) done += static_cast<std::size_t>(sent);
    }
}

bool Worker::next_line(std::string& line) {
    const auto end = read_.find('\n');
    if (end == std::string::npos) return false;
    line = read_.substr(0, end);
    read_.erase(0, end + 1);
    return true;
}

bool Worker::receive() {
    pollfd ready{socket_, POLLIN, 0};
    if (poll(&ready, 1, pause_ms) <= 0) {
        // Endless output of a script must not fill the memory.
        if (size_of_log(log_) > most_log) [[maybe_unused]]
            const auto cut = ftruncate(log_, most_printed);
        return true;
    }
    std::array<char, 65536> buffer;
    const auto got = recv(socket_, buffer.data(), buffer.size(), 0);
    if (got > 0) read_.append(buffer.data(), static_cast<std::size_t>(got));
    return got > 0 || (got < 0 && errno == EINTR);
}

Json Worker::call(Json request, const WorkerLimits& limits, const WorkerHost& host) {
    seconds_ = limits.seconds;
    request["seconds"] = limits.seconds;
    request["memory"] = std::clamp<std::uint64_t>(limits.memory, least_memory,
                                                  std::numeric_limits<std::int64_t>::max());
    request["number"] = ++calls_;
    const auto end_of_time = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                                std::chrono::duration<double>(seconds_ + grace));
    send(request.dump() + "\n");
    const auto is_answer = [&](const Json& said) {
        ready_ = true;
        if (said.contains("warn")) return host.warn(said["warn"]), false;
        if (said.contains("progress")) return host.progress(said["progress"]), false;
        if (const auto text = printed(); !text.empty()) host.warn("the script printed: " + text);
        if (said.contains("failed")) throw Failure(said["failed"].get<std::string>());
        return true;
    };
    std::string line;
    while (true) {
        while (next_line(line))
            if (auto said = understood(line); is_answer(said)) return said;
        if (host.cancelled()) {
            end();
            throw Cancelled{};
        }
        const bool open = receive();
        if (!open || Clock::now() > end_of_time) {
            end(!open);
            throw Failure(last_words());
        }
    }
}

Json Worker::understood(const std::string& line) {
    auto said = Json::parse(line, nullptr, false);
    const auto is = [&](const char* name, auto holds) {
        return said.contains(name) && (said[name].*holds)();
    };
    if (said.is_object() && (is("warn", &Json::is_string) || is("progress", &Json::is_number) ||
                             (is("number", &Json::is_number) && said["number"] == calls_ &&
                              (!said.contains("failed") || said["failed"].is_string()))))
        return said;
    // A late answer could be taken for the answer to another request.
    end();
    throw Failure(
        fmt::format("{}: the script wrote into the socket between its process and this "
                    "program; let it leave descriptors alone that it did not open",
                    script_));
}

void Worker::end(bool going) {
    close_if_open(socket_);
    if (process_ > 0) {
        // A process that ends by itself tells more than a killed one.
        siginfo_t gone{};
        for (int waited = 0;
             going && waited < most_going_ms &&
             waitid(P_PID, static_cast<id_t>(process_), &gone, WEXITED | WNOHANG | WNOWAIT) == 0 &&
             gone.si_pid == 0;
             ++waited)
            poll(nullptr, 0, 1);
        // The whole group, with all processes that the script has started.
        kill(-process_, SIGKILL);
        while (waitpid(process_, &status_, 0) < 0 && errno == EINTR) {}
    }
    process_ = -1;
    close_if_open(life_);
}

std::string Worker::printed() {
    const auto all = size_of_log(log_);
    if (all == 0) return {};
    auto out = read_log(log_, 0, std::min(all, most_printed));
    const auto left = all - out.size();
    [[maybe_unused]] const auto cut = ftruncate(log_, 0);
    while (!out.empty() && out.back() == '\n') out.pop_back();
    return left == 0 ? out : fmt::format("{} ... and {} more", out, size_text(left));
}

std::string Worker::last_words() {
    const auto log = end_of(log_);
    const bool slow = log.find("Timeout (") != std::string::npos;
    const auto place = slow || log.find("Fatal Python error") != std::string::npos
                           ? place_in(log, script_)
                           : std::string();
    const auto& where = place.empty() ? script_ : place;
    if (slow)
        return fmt::format(
            "{}: the script did not end within {}; raise `timeout` if it needs longer", where,
            duration_text(seconds_));
    if (!ready_) {
        const auto text = log.substr(0, log.find_last_not_of('\n') + 1);
        return fmt::format(
            "'{}' can't run scripts{}{}; name another Python by `python`, or in the environment "
            "variable FLUIDCARVE_PYTHON",
            interpreter_, text.empty() ? "" : ": ", text);
    }
    if (WIFEXITED(status_))
        return fmt::format(
            "{}: the script ended its process with code {}, as os._exit does; raise an exception "
            "in place of that",
            where, WEXITSTATUS(status_));
    const int number = WTERMSIG(status_);
    if (number == SIGKILL && place.empty())
        return fmt::format(
            "{}: the script's process was killed, perhaps because the machine's memory was full; "
            "--in-flight 1 runs one frame at a time",
            where);
    return fmt::format(
        "{}: the script's process crashed ({}); look for a fault in a library that it uses", where,
        strsignal(number));
}

}  // namespace fluidcarve
