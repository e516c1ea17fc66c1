#include "runtime/jobs/slurm.h"

#include "carve/base/failure.h"
#include "carve/base/one_line.h"
#include "carve/base/words.h"
#include "formats/file/full_path.h"
#include "graph/text/shell_word.h"
#include "runtime/jobs/slurm_texts.h"
#include "runtime/tell/exit_codes.h"
#include "runtime/tell/terminal.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <sys/wait.h>
#include <unistd.h>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <sstream>

namespace fluidcarve {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t mebibyte = 1024 * 1024;

/// A part of a script (slurm_texts) behind an empty line.
std::string script_part(std::string_view name) {
    return fmt::format("\n{}", slurm_texts().at(name));
}

/// The purpose of a step, and its number of tasks, as a comment.
std::string comment_of(const FarmStep& step) {
    std::size_t frames = 0;
    for (const auto& task : step.tasks) frames += task.frames().size();
    auto out = "# " + one_line(step.what);
    if (step.chunked)
        out +=
            fmt::format("; {} in {}", counted(frames, "frame"), counted(step.tasks.size(), "task"));
    std::vector<std::string> each;
    if (step.resources.seconds > 0)
        each.push_back("takes about " + duration_text(*step.resources.seconds));
    if (step.resources.disk > 0) each.push_back("writes about " + size_text(step.resources.disk));
    return out + (each.empty() ? "" : fmt::format("; a task {}", fmt::join(each, " and "))) + "\n";
}

std::string step_script(const FarmJob& job, const FarmStep& step) {
    auto out = std::string("#!/usr/bin/env bash\n");
    if (step.resources.cores > 0)
        out += fmt::format("#SBATCH --cpus-per-task={}\n", step.resources.cores);
    if (step.resources.memory > 0)
        out +=
            fmt::format("#SBATCH --mem={}M\n", (step.resources.memory + mebibyte - 1) / mebibyte);
    out +=
        "#SBATCH --requeue\n#SBATCH --kill-on-invalid-dep=yes\n#SBATCH --open-mode=append\n#SBATCH "
        "--signal=B:USR1@60\n";
    out += comment_of(step) + "\nchunks=(\n";
    for (const auto& task : step.tasks)
        out += "    " + (step.chunked ? "--frames=" + task.text() : std::string("''")) + "\n";
    out += fmt::format(")\ncommand=({})\n", shell_line(command_of(job, step, {})));
    return out + fmt::format("folder={}\n", shell_word(job.folder)) + script_part("slurm_task.sh");
}

std::string submit_program(const FarmJob& job) {
    auto out = fmt::format(
        "#!/usr/bin/env bash\n# Submits the steps of {} to Slurm, as {} wrote them. Options are "
        "handed to every sbatch: `submit --partition=fx`.\nset -euEo pipefail\n",
        one_line(job.pipeline), job_mark);
    auto status = job.prefix;
    status.insert(status.end(), {job.executable, "status", "--work", job.work});
    out +=
        fmt::format("name={}\nstatus={}\n", shell_word(job.name), shell_word(shell_line(status))) +
        script_part("slurm_submit.sh") + "\n";
    for (const auto& step : job.steps)
        out += fmt::format("step {} {}{}{}\n", step.name, step.tasks.size(),
                           step.needs.empty() ? "" : " ", fmt::join(step.needs, " "));
    return out + script_part("slurm_submitted.sh");
}

/// Whether a program of this name is in PATH.
bool is_in_path(const std::string& program) {
    std::istringstream folders(std::getenv("PATH") ? std::getenv("PATH") : "");
    for (std::string folder; std::getline(folders, folder, ':');)
        if (access((fs::path(folder.empty() ? "." : folder) / program).c_str(), X_OK) == 0)
            return true;
    return false;
}

/// Runs a program and waits for its end. @return its exit code
int run_program(const std::string& path) {
    std::fflush(nullptr);
    const auto child = fork();
    if (child == 0) {
        execl(path.c_str(), path.c_str(), nullptr);
        _exit(127);
    }
    int status = 0;
    if (child < 0) throw Failure(fmt::format("cannot start {}: no process is left", path));
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {}
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

std::vector<JobFile> slurm_files(const FarmJob& job) {
    std::vector<JobFile> files;
    for (const auto& step : job.steps)
        files.push_back({step.name + ".sbatch", step_script(job, step)});
    files.push_back({"submit", submit_program(job), true});
    return files;
}

std::string slurm_refusal(const FarmRequest& request) {
    if (!request.submit || is_in_path("sbatch")) return {};
    return "--submit: there is no sbatch in PATH; call this where Slurm is installed, or leave "
           "--submit out and run `submit` there";
}

int farm_slurm(const FarmJob& job, const FarmRequest& request) {
    const auto folder = full_path(request.output.empty() ? job.name : request.output);
    const auto submit = (folder / "submit").string();
    write_job_files(folder.string(), slurm_files(job));
    if (request.submit) {
        const int code = run_program(submit);
        return code == exit_code::done || code == exit_code::usage ? code : exit_code::node_failed;
    }
    if (!request.quiet)
        tell(fmt::format("{}: {}, {}; to submit them, type: {}", folder.string(),
                         counted(job.steps.size(), "step"), counted(job.tasks(), "task"),
                         shell_word(submit)));
    return exit_code::done;
}

}  // namespace fluidcarve
