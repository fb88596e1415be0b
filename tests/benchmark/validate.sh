#!/usr/bin/env bash
# validate.sh [--quick]: builds what measures `darboux validate` in build/benchmark, runs it, and writes the measured part of
# docs/reports/validate.md. Takes about two minutes beside the build, 0.5 GB of memory; the machine should do nothing else. With
# --quick a quarter of a minute, smaller meshes, and the report goes to build/benchmark/quick.
# Needs what .ci/packages lists as build and benchmark.
set -euo pipefail
. "$(dirname "$0")/common.sh"

build benchmark_validate
start
build/benchmark/bin/benchmark_validate "$work" "${quick[@]}" >"$work/tables"
{
  echo
  circumstances
  cat "$work/tables"
  echo
} >"$work/measured"
write_report validate.md "$work/measured"
