#!/usr/bin/env bash
# Starts a SLURM of one node on this machine, runs a command with it, and stops it.  As root:
#
#     scripts/local_slurm.sh snakemake ... --cluster "sbatch --parsable" [...]   # docs/guides/cluster.md
#     scripts/local_slurm.sh squeue
#
# It shows that a study runs on a SLURM cluster without there being one; it is no way to speed anything up.
# slurmctld, slurmd and munged (Debian: slurmctld slurmd slurm-client munge) run with a configuration and a key
# of their own in a scratch folder, on ports of their own, beside any SLURM that the machine may have.
# CPUS=N gives the node N processors (default: those of the machine).
#
# The exit status is the command's; 3 where SLURM is missing or does not start.
set -euo pipefail

say() { printf '%s\n' "$*" >&2; }

[ $# -gt 0 ] || { say "error: no command: expected one, like scripts/local_slurm.sh squeue"; exit 2; }
export PATH=$PATH:/usr/sbin
for program in munged slurmctld slurmd sbatch; do
    [ -n "$(type -P "$program")" ] || {
        say "error: no $program: get SLURM with: sudo apt-get install slurmctld slurmd slurm-client munge"
        exit 3
    }
done
[ "$EUID" -eq 0 ] || { say "error: slurmd starts jobs as root only; run this script as root"; exit 3; }

dir=$(mktemp -d "${TMPDIR:-/tmp}/slurm.XXXXXX")
chmod 755 "$dir"
pids=()

stop() {
    local status=$? pid
    trap - EXIT
    scancel --state=PENDING,RUNNING --user=root 2>/dev/null || true
    for pid in "${pids[@]}"; do
        kill "$pid" 2>/dev/null || true
    done
    wait 2>/dev/null || true
    rm -rf "$dir"
    exit "$status"
}
trap stop EXIT
trap 'exit 130' INT TERM

free_port() {
    "${PYTHON:-/usr/bin/python3}" -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])'
}

host=$(hostname -s)
mkdir "$dir/state" "$dir/spool"
cat >"$dir/slurm.conf" <<END
ClusterName=local
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$(free_port)
SlurmdPort=$(free_port)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$dir/munge.socket
CredType=cred/munge
SlurmctldPidFile=$dir/slurmctld.pid
SlurmdPidFile=$dir/slurmd.pid
SlurmctldLogFile=$dir/slurmctld.log
SlurmdLogFile=$dir/slurmd.log
StateSaveLocation=$dir/state
SlurmdSpoolDir=$dir/spool
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
SchedulerParameters=defer,batch_sched_delay=1,sched_interval=1
NodeName=$host NodeAddr=127.0.0.1 CPUs=${CPUS:-$(nproc)} State=UNKNOWN
PartitionName=local Nodes=$host Default=YES MaxTime=INFINITE State=UP
END
export SLURM_CONF=$dir/slurm.conf

mungekey --create --keyfile="$dir/munge.key" >/dev/null
munged --foreground --force --socket="$dir/munge.socket" --key-file="$dir/munge.key" --pid-file="$dir/munge.pid" \
    --log-file="$dir/munge.log" --seed-file="$dir/munge.seed" >"$dir/munge.out" 2>&1 &
pids+=($!)
for _ in $(seq 100); do
    [ ! -S "$dir/munge.socket" ] || break
    sleep 0.1
done
slurmctld -D -i >"$dir/slurmctld.out" 2>&1 &
pids+=($!)
slurmd -D -N "$host" >"$dir/slurmd.out" 2>&1 &
pids+=($!)
for _ in $(seq 120); do
    [ "$(sinfo -h -o %T 2>/dev/null)" != idle ] || break
    sleep 0.5
done
if [ "$(sinfo -h -o %T 2>/dev/null)" != idle ]; then
    say "error: SLURM does not start on this machine:"
    tail -n 5 "$dir"/*.log "$dir"/*.out >&2 || true
    exit 3
fi

set +e
"$@"
