#!/bin/bash
# A sweep as an array of Slurm jobs, one shard each. Submit it and merge when all have ended:
#   jobs=$(sbatch --parsable examples/jobs/slurm.sh)
#   sbatch --dependency=afterany:$jobs --wrap "hmax merge whole.sqlite shards/*.sqlite"
# Requeued jobs go on where they were killed. SWEEP is the sweep, a file or options.
#SBATCH --array=1-8
#SBATCH --cpus-per-task=1
#SBATCH --requeue
set -eu
mkdir -p shards
exec hmax sweep ${SWEEP:---methods rk4,ode45 --h 0.1,0.05,0.02,0.01} --resume \
  --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_MAX" --out "shards/$SLURM_ARRAY_TASK_ID.sqlite"
