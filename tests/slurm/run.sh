#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# A study on a real Slurm of this machine (munge, slurmctld and slurmd, without systemd): an array whose tasks share the
# study; one is killed with its program and requeued, one is requeued by Slurm; then the report, which waits for them. The
# results must be those of one process, but for `seconds`. About half a minute. Skips with a message where Slurm is missing.
# Usage: bash tests/slurm/run.sh [build folder, default build]
set -euo pipefail
cd "$(dirname "$0")/../.."
build=${1:-build}
program=$PWD/$build/bin/thermorig
here=$PWD/tests/slurm

skip() {
  echo "skipped: $1"
  [ -z "${THERMORIG_EVERYTHING:-}" ] || exit 1 # a skip is no pass
  exit 0
}
PATH=$PATH:/usr/sbin
for needed in munged slurmctld slurmd sbatch scontrol python3; do
  command -v "$needed" >/dev/null || skip "$needed is not installed (bash app/setup.sh deep)"
done
[ -x "$program" ] || skip "$program is not built (target thermorig)"

folder=$(mktemp -d)
daemons=()
end() {
  local code=$?
  if [ "$code" -ne 0 ]; then tail -n 40 "$folder"/*.log "$folder"/tasks/* 2>/dev/null || true; fi
  for daemon in "${daemons[@]}"; do kill "$daemon" 2>/dev/null || true; done
  wait 2>/dev/null || true
  rm -rf "$folder"
  exit "$code"
}
trap end EXIT

# wait_until SECONDS COMMAND...
wait_until() {
  local last=$((SECONDS + $1))
  shift
  until "$@"; do
    [ "$SECONDS" -lt "$last" ] || { echo "waited in vain for: $*" >&2; return 1; }
    sleep 0.1
  done
}

# ---- Slurm, with its own key, socket and ports --------------------------------------------------------------------
free_ports() {
  python3 -c 'import socket
sockets = [socket.socket() for _ in range(2)]
for one in sockets: one.bind(("", 0))
print(*(one.getsockname()[1] for one in sockets))'
}
read -r controller_port node_port < <(free_ports)
host=$(hostname -s)
user=$(id -un)
mkdir "$folder"/{state,spool,tasks}
chmod 0755 "$folder"
(umask 077 && dd if=/dev/urandom of="$folder/munge.key" bs=1024 count=1 status=none)
cat >"$folder/slurm.conf" <<CONF
ClusterName=thermorig
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$controller_port
SlurmdPort=$node_port
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket,cred_expire=5
CredType=cred/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SchedulerType=sched/builtin
SchedulerParameters=sched_interval=2,batch_sched_delay=0
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
MpiDefault=none
ReturnToService=2
KillWait=5
MinJobAge=300
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES State=UP MaxTime=10
CONF
export SLURM_CONF=$folder/slurm.conf
munged --force --foreground --key-file="$folder/munge.key" --socket="$folder/munge.socket" \
  --pid-file="$folder/munged.pid" --seed-file="$folder/munge.seed" --log-file="$folder/munged.log" >/dev/null 2>&1 &
daemons+=($!)
wait_until 30 test -S "$folder/munge.socket"
slurmctld -D -c >/dev/null 2>&1 &
daemons+=($!)
slurmd -D -N "$host" >/dev/null 2>&1 &
daemons+=($!)
is_idle() { sinfo -h -o %T 2>/dev/null | grep -qx idle; }
wait_until 60 is_idle
echo "Slurm $(sinfo --version | cut -d' ' -f2) is up after $SECONDS s"

# ---- the study ----------------------------------------------------------------------------------------------------
cd "$folder"
for words in "garden --world honest --simulated=3" "garden --world honest --simulated=4" "laboratory --world honest --simulated=5"; do
  # shellcheck disable=SC2086
  "$program" record --fast --environment $words --plan quick --speeds 40,80 --frames-per-leg 12 >/dev/null
done
study=(--study recordings --nf 3 --nr 3 --reference-seeds 1,2,3 --epochs "${THERMORIG_SLURM_EPOCHS:-300}")
"$program" evaluate "${study[@]}" -o one >/dev/null
echo "one process has its results after $SECONDS s"

printf '#!/usr/bin/env bash\nexec bash %q %q %s\n' "$here/task.sh" "$program" "${study[*]}" >task
array=$(sbatch --parsable --requeue --array=1-4 --ntasks=1 --output="$folder/tasks/%a" --open-mode=append task)
draw="$program evaluate ${study[*]} --draw shared --require-complete"
report=$(sbatch --parsable --dependency="afterok:$array" --output="$folder/tasks/draw" --wrap "$draw")

wait_until 60 test -e shared/results
code=0
$draw >early 2>&1 || code=$?
[ "$code" -eq 9 ] || { echo "a study that is not complete was drawn (exit code $code)"; cat early; exit 1; }

wait_until 60 test -e third.is_running
scontrol requeue "${array}_3" # Slurm ends it and starts it again
state_of() { scontrol -o show job "$1" | grep -o 'JobState=[A-Z]*' | sort -u; }
has_ended() { state_of "$1" | grep -Eq 'COMPLETED|FAILED|CANCELLED|TIMEOUT'; }
wait_until 180 has_ended "$report"
[ "$(state_of "$report")" = JobState=COMPLETED ] || { state_of "$report"; exit 1; }
restarts=$(scontrol -o show job "$array" | grep -o 'Restarts=[1-9]' | wc -l)
[ "$restarts" -eq 2 ] || { echo "$restarts tasks were started again, not 2"; exit 1; }

[ -e second.is_killed ] || { echo "no program was killed"; exit 1; }

python3 "$here/same_results.py" one/results shared/results
cmp -s <(grep -v 'added up' one/report.md) <(grep -v 'added up' shared/report.md) ||
  { echo "the reports differ"; diff one/report.md shared/report.md; exit 1; }
echo "an array of 4 tasks, one of them killed and two started again, gives what one process gives: $SECONDS s"
