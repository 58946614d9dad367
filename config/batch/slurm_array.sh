#!/bin/bash
# A batch as a job array on a Slurm cluster; the number of tasks is the number of parts:
#
#     sbatch --array=1-8 slurm_array.sh reach_grid.yaml --out DIR
#
# DIR is on a file system that all nodes share. What ran out of time goes on when the same is submitted again: finished
# requests are not planned twice. When all have ended, `fjr batch reach_grid.yaml --out DIR` writes the whole summary and
# plans what is still missing.
#SBATCH --job-name=fjr-batch
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=4
#SBATCH --mem-per-cpu=500M
#SBATCH --time=04:00:00
#SBATCH --signal=B:TERM@30
set -eu
exec fjr batch "$@" --jobs "${SLURM_CPUS_PER_TASK:-1}" --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_MAX"
