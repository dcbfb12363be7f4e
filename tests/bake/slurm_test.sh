#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A Slurm cluster of two virtual nodes on this machine bakes eight shards. It loses a worker and a node's daemon to
# kill -9, and a shard's journal to truncation. On re-submission at the latest it ends in the response file of one
# process.
#   tests/bake/slurm_test.sh build/release/bin/palpate [0]
# 0: automatic sampling, each round an array of eight shards that the round before submits.
# Ends with 77 where it cannot run.
set -euo pipefail

palpate=$(realpath "$1")
skip() { echo "skipped: $*"; exit 77; }
[ "$(id -u)" = 0 ] || skip "only root can start a Slurm cluster"
PATH=$PATH:/usr/sbin:/sbin
for program in munged slurmctld slurmd sbatch squeue; do
  command -v "$program" >/dev/null || skip "no $program (Debian: slurmctld slurmd slurm-client munge)"
done

folder=$(mktemp -d /tmp/palpate-slurm.XXXXXX)
export SLURM_CONF=$folder/slurm.conf
daemons=()

# A slurmstepd outlives its slurmd, and a worker its slurmstepd.
descendants() {
  grep -lsxz "SLURM_CONF=$SLURM_CONF" /proc/[0-9]*/environ | cut -d / -f 3 || true
}
end() {
  local code=$?
  [ "$code" = 0 ] || { tail -n 20 "$folder"/*.log "$folder"/work/shards/*.log 2>/dev/null || true; }
  kill "${daemons[@]}" 2>/dev/null || true
  sleep 0.3
  kill -9 "${daemons[@]}" $(descendants) 2>/dev/null || true
  rm -rf "$folder"
  exit "$code"
}
trap end EXIT

# Waits at most $1 s until the rest is true.
within() {
  local limit=$(($(date +%s) + $1))
  shift
  until "$@"; do
    if [ "$(date +%s)" -ge "$limit" ]; then
      echo "not within the time: $*" >&2
      return 1
    fi
    sleep 0.1
  done
}

start_cluster() {
  local port=$((20000 + RANDOM % 30000))
  mkdir "$folder/munge" "$folder/state"
  dd if=/dev/urandom of="$folder/munge/key" bs=1 count=1024 status=none
  chmod 700 "$folder" "$folder/munge"
  chmod 600 "$folder/munge/key"
  munged --foreground --force --socket="$folder/munge/socket" --key-file="$folder/munge/key" \
    --pid-file="$folder/munge/pid" --seed-file="$folder/munge/seed" --log-file="$folder/munge/log" \
    --num-threads=2 >"$folder/munged.log" 2>&1 &
  daemons+=($!)
  cat >"$SLURM_CONF" <<END
ClusterName=palpate
SlurmctldHost=localhost(127.0.0.1)
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge/socket
CredType=cred/munge
CryptoType=crypto/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
SlurmctldPort=$port
SlurmctldPidFile=$folder/slurmctld.pid
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool.%n
SlurmdPidFile=$folder/slurmd.%n.pid
ReturnToService=2
SlurmdTimeout=6
KillWait=2
MinJobAge=300
JobRequeue=1
SchedulerParameters=batch_sched_delay=0,sched_interval=2
NodeName=n1 NodeAddr=127.0.0.1 NodeHostname=localhost Port=$((port + 1)) CPUs=2
NodeName=n2 NodeAddr=127.0.0.1 NodeHostname=localhost Port=$((port + 2)) CPUs=2
PartitionName=all Nodes=ALL Default=YES State=UP
END
  printf 'CgroupPlugin=cgroup/v1\nCgroupAutomount=no\n' >"$folder/cgroup.conf"
  within 10 test -S "$folder/munge/socket"
  slurmctld -D -c >"$folder/slurmctld.log" 2>&1 &
  daemons+=($!)
  start_node n1
  start_node n2
  within 30 both_idle || skip "the cluster's nodes do not come up"
}
both_idle() { [ "$(sinfo -h -N -t idle -o %N 2>/dev/null | sort -u | wc -l)" = 2 ]; }
declare -A node
start_node() {
  slurmd -D -N "$1" >"$folder/slurmd.$1.log" 2>&1 &
  node[$1]=$!
  daemons+=($!)
}

# Process ids of workers that are in the middle of their shard.
workers() {
  local pid shard
  for pid in $(grep -lsxz "$palpate" /proc/[0-9]*/cmdline | cut -d / -f 3); do
    shard=$( (tr '\0' ' ' <"/proc/$pid/cmdline" | sed -n "s|.* $folder/.* --shard \([0-9]*\)/8 .*|\1|p") 2>/dev/null) || true
    if [ "$(stat -c %s "$folder/work/shards/$shard-of-8.journal" 2>/dev/null || echo 0)" -gt 64 ]; then echo "$pid"; fi
  done
}
some_work() { [ -n "$(workers)" ]; }
queue_empty() { [ -z "$(squeue -h 2>/dev/null)" ]; }
# A shard's journal whose bake has ended.
finished_shard() {
  local file
  for file in "$folder"/work/shards/*.journal; do
    [ -e "$file" ] || continue
    if [ "$(stat -c %s "$file")" -gt 1000 ] && flock -n "$file" true; then
      echo "$file"
      return 0
    fi
  done
  return 1
}
submit() { "$palpate" submit "$folder/scene.toml" --shards 8 --work "$folder/work" -o "$folder/cluster.palp" --quiet; }

start_cluster
"$palpate" synth slab --out "$folder" --scale 0.5 --friction 0 --tool-radius 0.003 --depth 0.001 \
  --spacing "${2:-0.008}" --quiet
printf 'normal_points = 4\n[solver]\nmesh_size = 1\n[response]\ntolerance = 0.016\n' >>"$folder/scene.toml"
SECONDS=0
"$palpate" build "$folder/scene.toml" --work "$folder/single" -o "$folder/single.palp" --quiet --threads 2
limit=$((60 + 5 * SECONDS))

submit
within $limit some_work
kill -9 "$(workers | head -1)"
echo "killed a worker"
kill -9 "${node[n2]}"
echo "killed the daemon of n2"
within $limit finished_shard >/dev/null
shard=$(finished_shard)
truncate -s $(($(stat -c %s "$shard") * 3 / 5)) "$shard"
echo "cut $(basename "$shard")"
within $limit queue_empty

if [ ! -e "$folder/cluster.palp" ]; then
  tail -n 1 "$folder/work/shards/merge.log"
  start_node n2
  submit
  within $limit queue_empty
fi
rounds=$(grep -o '"rounds":[0-9]*' "$folder/single.palp" -a || true)
[ "${2:-}" != 0 ] || [ "${rounds#*:}" -gt 1 ] || { echo "one round is no test of several: $rounds"; exit 1; }
cmp "$folder/single.palp" "$folder/cluster.palp"
echo "the same response file, $(stat -c %s "$folder/cluster.palp") bytes"
