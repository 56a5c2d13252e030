#!/bin/sh
# Cooks a planned world on Slurm, on this machine alone, as a cluster would:
#   gtx world plan MODEL... -o WORLD --engine slurm && slurm.sh WORLD
# Needs root and Debian's packages: apt-get install slurm-wlm munge. Where a cluster is running
# already, WORLD/slurm/submit.sh is all it takes; WORLD must be a folder that its machines see.
set -eu
world=$(cd "$1" && pwd)
home=$(mktemp -d) host=$(hostname -s) cpus=$(nproc)
memory=$(awk '/MemTotal/ {print int($2 / 1024)}' /proc/meminfo)
mkdir "$home/state" "$home/spool"

cat >"$home/slurm.conf" <<EOF
ClusterName=one
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
StateSaveLocation=$home/state
SlurmdSpoolDir=$home/spool
SlurmctldPidFile=$home/slurmctld.pid
SlurmdPidFile=$home/slurmd.pid
SlurmctldLogFile=$home/slurmctld.log
SlurmdLogFile=$home/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
ReturnToService=2
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/linux
MpiDefault=none
NodeName=$host NodeAddr=127.0.0.1 CPUs=$cpus RealMemory=$memory State=UNKNOWN
PartitionName=main Nodes=$host Default=YES MaxTime=INFINITE State=UP
EOF
export SLURM_CONF="$home/slurm.conf"

stop() {
    kill "$node" "$controller" ${munge:+"$munge"} 2>/dev/null || true
    wait || true
    rm -rf "$home"
}
munge=
if ! munge -n >/dev/null 2>&1; then
    mkdir -p /run/munge
    chown munge:munge /run/munge
    runuser -u munge -- munged --foreground &
    munge=$!
fi
slurmctld -D >"$home/slurmctld.out" 2>&1 &
controller=$!
sleep 2
slurmd -D >"$home/slurmd.out" 2>&1 &
node=$!
trap stop EXIT
until sinfo -h -o %t | grep -q idle; do sleep 1; done

job=$(sh "$world/slurm/submit.sh")
while squeue -h | grep -q .; do sleep 1; done
scontrol show job "$job" | grep -o 'JobState=[A-Z]*'
test -s "$world/tileset.json"
