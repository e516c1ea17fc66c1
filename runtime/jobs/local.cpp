#include "runtime/jobs/local.h"

#include "carve/base/words.h"
#include "formats/file/input_file.h"
#include "formats/file/output_file.h"
#include "graph/text/shell_word.h"
#include "runtime/run/task.h"
#include "runtime/tell/exit_codes.h"
#include "runtime/tell/terminal.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <sstream>
#include <thread>

namespace fluidcarve {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto between_looks = std::chrono::milliseconds(10);
constexpr int not_started = 127;

/// A running task.
struct Running {
    std::size_t step = 0, task = 0;
    pid_t process = 0;
    std::string log;  ///< path
    Clock::time_point start{};
};

/// Progress of a step.
struct StepState {
    std::size_t next = 0;  ///< the first task that has not started
    std::size_t done = 0;
    bool failed = false;  ///< a task failed
};

/// Starts a command in a process group of its own, with its output in a file.
/// @throws Failure
pid_t start(const std::vector<std::string>& words, const std::string& log) {
    std::vector<char*> arguments;
    for (const auto& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    const int file = open(log.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
    if (file < 0) throw Failure(fmt::format("cannot write {}: {}", log, std::strerror(errno)));
    const auto parent = getpid();
    const auto process = fork();
    if (process == 0) {
        // Only calls that are safe between fork and exec.
        setpgid(0, 0);
        prctl(PR_SET_PDEATHSIG, SIGTERM);
        if (getppid() != parent) _exit(not_started);
        sigset_t none;
        sigemptyset(&none);
        sigprocmask(SIG_SETMASK, &none, nullptr);
        for (const int number : {SIGPIPE, SIGXFSZ}) signal(number, SIG_DFL);
        dup2(file, STDOUT_FILENO);
        dup2(file, STDERR_FILENO);
        execvp(arguments[0], arguments.data());
        _exit(not_started);
    }
    close(file);
    if (process < 0) throw Failure(fmt::format("cannot start a process: {}", std::strerror(errno)));
    setpgid(process, process);
    return process;
}

/// The failures in a log; if there are none, its last line.
std::vector<std::string> failures_in(const std::string& log) {
    std::vector<std::string> out;
    std::string last;
    std::istringstream in(text_of_own_file(log));
    for (std::string line; std::getline(in, line);) {
        if (line.starts_with("failed: ")) out.push_back(line.substr(std::strlen("failed: ")));
        if (!line.empty()) last = line;
    }
    return out.empty() ? std::vector{last} : out;
}

/// The tasks of a job, from the first to the last.
class LocalFarm {
public:
    LocalFarm(const FarmJob& job, const FarmRequest& request)
        : job_(job), request_(request), states_(job.steps.size()) {}

    int run() {
        const auto start = Clock::now();
        while (true) {
            if (request_.cancelled()) return stop();
            while (running_.size() < static_cast<std::size_t>(request_.processes) && begin_next()) {
            }
            if (running_.empty()) break;
            if (!look()) std::this_thread::sleep_for(between_looks);
        }
        if (code_ != exit_code::done) return tell_rest();
        say(fmt::format(
            "done: {} in {}", counted(done_, "task"),
            duration_text(std::chrono::duration<double>(Clock::now() - start).count())));
        return exit_code::done;
    }

private:
    void say(const std::string& line) const {
        if (!request_.quiet) tell(line);
    }

    std::string name(const Running& task) const {
        const auto& step = job_.steps[task.step];
        return task_name(step.name, step.tasks[task.task]);
    }

    bool needs(std::size_t step, std::size_t other) const {
        const auto& names = job_.steps[step].needs;
        return std::ranges::find(names, job_.steps[other].name) != names.end();
    }
    /// Whether all steps that it needs are done. A step comes after those.
    bool ready(std::size_t step) const {
        for (std::size_t other = 0; other < step; ++other)
            if (needs(step, other) && states_[other].done < job_.steps[other].tasks.size())
                return false;
        return true;
    }

    /// Starts the next task that may start. @return whether there was one
    bool begin_next() {
        if (!again_.empty()) {
            const auto task = again_.back();
            again_.pop_back();
            return begin(task.step, task.task), true;
        }
        for (std::size_t step = 0; step < states_.size(); ++step)
            if (states_[step].next < job_.steps[step].tasks.size() && ready(step))
                return begin(step, states_[step].next++), true;
        return false;
    }

    void begin(std::size_t step, std::size_t task) {
        Running running{step, task, 0, {}, Clock::now()};
        const auto words = command_of(job_, job_.steps[step], job_.steps[step].tasks[task]);
        running.log =
            fmt::format("{}/logs/{}.log", job_folder(job_.work, job_.name), name(running));
        OutputFile::write(running.log, "$ " + shell_line(words) + "\n");
        running.process = start(words, running.log);
        running_.push_back(std::move(running));
    }

    /// Handles the tasks that have ended. @return whether one has
    bool look() {
        bool ended = false;
        for (std::size_t n = 0; n < running_.size();) {
            int status = 0;
            if (waitpid(running_[n].process, &status, WNOHANG) == 0) {
                ++n;
                continue;
            }
            const auto task = running_[n];
            running_.erase(running_.begin() + static_cast<std::ptrdiff_t>(n));
            end(task, status);
            ended = true;
        }
        return ended;
    }

    void end(const Running& task, int status) {
        auto& state = states_[task.step];
        if (WIFEXITED(status) && WEXITSTATUS(status) == exit_code::done) {
            ++state.done;
            ++done_;
            const auto seconds = std::chrono::duration<double>(Clock::now() - task.start).count();
            return say(fmt::format("{}: done in {}, {} of {}", name(task), duration_text(seconds),
                                   done_, counted(job_.tasks(), "task")));
        }
        const auto once = std::pair(task.step, task.task);
        if (WIFSIGNALED(status) && std::ranges::find(repeated_, once) == repeated_.end()) {
            repeated_.push_back(once);
            again_.push_back(task);
            return tell(fmt::format("warning: {}: killed by signal {}; runs again", name(task),
                                    WTERMSIG(status)));
        }
        state.failed = true;
        const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
        if (code_ == exit_code::done)
            code_ = code > exit_code::interrupted || code == not_started ? exit_code::node_failed
                                                                         : code;
        for (const auto& failure :
             WIFSIGNALED(status) ? std::vector{fmt::format("killed by signal {}", WTERMSIG(status))}
                                 : failures_in(task.log))
            tell(fmt::format(
                "failed: {}: {}", name(task),
                code == not_started
                    ? "cannot run " + command_of(job_, job_.steps[task.step], {}).front()
                    : failure));
        tell(fmt::format("  its log: {}", task.log));
    }

    /// Prints what was not run, and how to continue.
    int tell_rest() {
        std::vector<std::string> left;
        std::vector<bool> failed;  // or needs one that failed
        for (std::size_t step = 0; step < states_.size(); ++step) {
            bool hopeless = false;
            for (std::size_t other = 0; other < step; ++other)
                hopeless = hopeless || (needs(step, other) && failed[other]);
            failed.push_back(states_[step].failed || hopeless);
            if (hopeless) left.push_back(job_.steps[step].name);
        }
        if (!left.empty())
            tell(fmt::format("not run, since they need what failed: {}", fmt::join(left, ", ")));
        tell("to continue, fix the cause, then run: " + job_.again);
        return code_;
    }

    int stop() {
        for (const auto& task : running_) kill(-task.process, SIGTERM);
        for (const auto& task : running_) waitpid(task.process, nullptr, 0);
        tell("interrupted; to continue, run: " + job_.again);
        return exit_code::interrupted;
    }

    const FarmJob& job_;
    const FarmRequest& request_;
    std::vector<StepState> states_;
    std::vector<Running> running_, again_;
    /// Tasks that have run again, by step and task.
    std::vector<std::pair<std::size_t, std::size_t>> repeated_;
    std::size_t done_ = 0;
    int code_ = exit_code::done;
};

}  // namespace

int farm_locally(const FarmJob& job, const FarmRequest& request) {
    return LocalFarm(job, request).run();
}

}  // namespace fluidcarve
