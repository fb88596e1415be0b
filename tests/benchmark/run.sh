#!/usr/bin/env bash
# run.sh [--quick]: builds the benchmark in build/benchmark, runs it, and writes the measured part of
# docs/reports/evaluation.md. Takes under ten minutes beside the build; the machine should do nothing else. With --quick
# under two, few rounds, and it goes to build/benchmark/quick. Time against error of every method: darboux work-precision.
# Needs what .ci/packages lists as build and benchmark (.ci/install build benchmark); OCCT may be absent.
set -euo pipefail
. "$(dirname "$0")/common.sh"

build benchmark_evaluation
start
build/benchmark/bin/benchmark_evaluation --table "${quick[@]}" >"$work/tables"

{
  echo
  circumstances
  cat "$work/tables"
  echo
} >"$work/measured"
write_report evaluation.md "$work/measured"
