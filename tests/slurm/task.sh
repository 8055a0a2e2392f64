#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# A task of the array of run.sh. The second one, when it runs first, has its program killed while it trains, and is requeued
# as after the loss of a node; the third one says that it runs: run.sh has it requeued.
# Usage: task.sh PROGRAM WORDS_OF_THE_STUDY...
set -euo pipefail
program=$1
shift
part=(evaluate "$@" -o shared --jobs 1 --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT")
case $SLURM_ARRAY_TASK_ID:${SLURM_RESTART_COUNT:-0} in
  2:0)
    "$program" "${part[@]}" &
    # Once one of its jobs is done, it trains the next.
    until "$program" evaluate "$@" -o shared --list-jobs | awk 'NR % 4 == 2' | grep -q 'done'; do sleep 0.02; done
    kill -KILL $!
    touch second.is_killed
    scontrol requeue "$SLURM_JOB_ID"
    sleep 30
    ;;
  3:0)
    touch third.is_running
    exec "$program" "${part[@]}"
    ;;
  *) "$program" "${part[@]}" ;;
esac
