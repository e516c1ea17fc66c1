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
