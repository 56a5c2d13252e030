#!/bin/sh
# Cooks a folder of models on a cluster that runs Slurm, as a job array: every machine takes its
# share of the models, and keeps what it cooks in a cache that all of them see.
#   slurm.sh MODELS OUT CACHE [TASKS [GTX]]
# Prints the job's number. A report of each task is left in OUT; the job fails where a model does,
# and, submitted again, cooks only what is missing or has changed.
set -eu
absolute() { case $1 in /*) printf '%s' "$1" ;; *) printf '%s' "$PWD/$1" ;; esac; }
models=$(absolute "$1") out=$(absolute "$2") cache=$(absolute "$3")
tasks=${4:-8} gtx=$(command -v "${5:-gtx}")
mkdir -p "$out"
export models out cache tasks gtx
sbatch --parsable --array="1-$tasks" --output="$out/cook-%a.log" --export=ALL <<'EOF'
#!/bin/sh
exec "$gtx" cook "$models" -o "$out" --cache "$cache" --if-changed \
    --shard "$SLURM_ARRAY_TASK_ID/$tasks" --jobs "${SLURM_CPUS_ON_NODE:-1}" \
    --report "$out/cook-$SLURM_ARRAY_TASK_ID.json"
EOF
