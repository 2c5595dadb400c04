#!/bin/bash
# A sweep in shards by GNU parallel: one process for each core, and each shard goes on where it was killed.
# SWEEP is the sweep, a file or options; SHARDS how many parts it has.
set -eu
shards=${SHARDS:-8}
mkdir -p shards
parallel --retries 3 hmax sweep ${SWEEP:---methods rk4,ode45 --h 0.1,0.05,0.02,0.01} --resume \
  --shard "{}/$shards" --out "shards/{}.sqlite" ::: $(seq "$shards")
hmax merge whole.sqlite shards/*.sqlite
