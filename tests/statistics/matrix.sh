#!/usr/bin/env bash
# matrix.sh [--results FILE.jsonl] [--shard I/N] [--cells PART-OF-KEY]... [--usable N] [--tries N]: builds the matrix of
# fits in build/benchmark and runs it: every kind, part of the surface, number of points, outliers and noise, up to 300
# data sets each. All of it takes some thirty hours of one core; a results file is resumed. Prints the cells that are
# outside.
set -euo pipefail
arguments=("$@")
set --  # common.sh knows others
. "$(dirname "$0")/../benchmark/common.sh"

build fit_matrix
build/benchmark/bin/fit_matrix "${arguments[@]}"
