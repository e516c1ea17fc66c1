#include "runtime/jobs/slurm.h"

#include "carve/base/failure.h"
#include "carve/base/one_line.h"
#include "carve/base/words.h"
#include "formats/file/full_path.h"
#include "graph/text/shell_word.h"
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

/// What a task's script does after it has set `chunks`, `command` and `folder`.
constexpr const char* task_script = R"sh(
chunk=${chunks[$1 + SLURM_ARRAY_TASK_ID]}
export FLUIDCARVE_THREADS=${FLUIDCARVE_THREADS:-${SLURM_CPUS_PER_TASK:-$(nproc)}}

# The program runs beside this shell, which hears signals: SIGUSR1 a minute before the time limit,
# SIGTERM when the job is cancelled. SIGTERM reaches the program without help.
late=
stopped=
trap 'late=yes; kill -TERM "$program"' USR1
trap 'stopped=yes' TERM

if ! cd -- "$folder"; then
    echo "$SLURMD_NODENAME does not see $folder; put the project where all machines see it" >&2
    exit 3
fi
"${command[@]}" ${chunk:+"$chunk"} &
program=$!
wait "$program"
code=$?
# A signal ends the first wait, not the program.
if [ -n "$late$stopped" ]; then
    wait "$program"
    code=$?
fi
[ $code -ne 0 ] || exit 0

# Another start finds what is done already. It helps against a short time limit and what passes,
# such as a full disk; not against wrong usage.
starts=$((${SLURM_RESTART_COUNT:-0} + 1))
if { [ -n "$late" ] && [ $starts -lt 20 ]; } ||
    { [ -z "$stopped" ] && [ $code -ne 2 ] && [ $starts -lt 3 ]; }; then
    echo "start $starts ended with code $code; the next one follows" >&2
    # The request itself ends this start by a SIGTERM, which must not end the request.
    trap '' TERM
    scontrol requeue "${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID" && exit $code
fi
echo "ended with code $code; what waits for it is cancelled. Submit the job again to continue" >&2
exit $code
)sh";

/// What `submit` does after it has set `name` and `status`, before its calls of `step`.
constexpr const char* submit_script = R"sh(
here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
for program in sbatch scancel squeue; do
    if ! command -v "$program" >/dev/null; then
        echo "submit: there is no $program; run this where Slurm is installed." \
            "Nothing is submitted" >&2
        exit 2
    fi
done
if [ -e "$here/jobs" ]; then
    queued=$(squeue --noheader --format=%F --jobs="$(paste -sd, "$here/jobs")" 2>/dev/null |
        sort -u | paste -sd' ') || true
    if [ -n "$queued" ]; then
        echo "submit: this job is queued already; \`scancel $queued\` first." \
            "Nothing is submitted" >&2
        exit 2
    fi
fi
mkdir -p -- "$here/logs"

options=("$@")
ids=()
# All of it is submitted, or nothing.
trap '[ ${#ids[@]} -eq 0 ] || scancel "${ids[@]}"
echo "submit: failed; nothing is submitted" >&2' EXIT

# step STEP TASKS [NEEDED_STEP...]: an array of at most 1000 tasks for each 1000, since Slurm's
# MaxArraySize is 1001 unless it is set.
declare -A jobs
step() {
    local step=$1 tasks=$2 needed first most id after=
    shift 2
    for needed; do after+=${jobs[$needed]}; done
    for ((first = 0; first < tasks; first += 1000)); do
        most=$((tasks - first < 1000 ? tasks - first : 1000))
        id=$(sbatch --parsable --array="0-$((most - 1))" ${after:+--dependency="afterok$after"} \
            --job-name="$name.$step" --output="${here//%/%%}/logs/$step.%A_%a.log" \
            "${options[@]}" "$here/$step.sbatch" "$first")
        ids+=("${id%%;*}")
        jobs[$step]+=:${id%%;*}
    done
}

)sh";

/// What `submit` does after its calls of `step`.
constexpr const char* submitted_script = R"sh(
trap - EXIT
printf '%s\n' "${ids[@]}" >"$here/jobs"
echo "submitted: ${ids[*]}"
echo "how far:   $status"
echo "logs:      $here/logs"
echo "cancel:    scancel ${ids[*]}"
)sh";

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
    return out + fmt::format("folder={}\n", shell_word(job.folder)) + task_script;
}

std::string submit_program(const FarmJob& job) {
    auto out = fmt::format(
        "#!/usr/bin/env bash\n# Submits the steps of {} to Slurm, as {} wrote them. Options are "
        "handed to every sbatch: `submit --partition=fx`.\nset -euEo "
        "pipefail\n",
        one_line(job.pipeline), job_mark);
    auto status = job.prefix;
    status.insert(status.end(), {job.executable, "status", "--work", job.work});
    out +=
        fmt::format("name={}\nstatus={}\n", shell_word(job.name), shell_word(shell_line(status))) +
        submit_script;
    for (const auto& step : job.steps)
        out += fmt::format("step {} {}{}{}\n", step.name, step.tasks.size(),
                           step.needs.empty() ? "" : " ", fmt::join(step.needs, " "));
    return out + submitted_script;
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
