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
