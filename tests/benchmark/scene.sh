#!/usr/bin/env bash
# scene.sh [--quick]: builds what measures plans of scenes in build/benchmark, runs it, and writes the measured part of
# docs/reports/scene.md. Takes about a minute beside the build; the machine should do nothing else. With --quick a few seconds, and the
# report goes to build/benchmark/quick. Needs what .ci/packages lists as build and benchmark.
set -euo pipefail
. "$(dirname "$0")/common.sh"

build benchmark_scene
start
build/benchmark/bin/benchmark_scene "${quick[@]}" >"$work/tables"
{
  echo
  circumstances
  cat "$work/tables"
  echo
} >"$work/measured"
write_report scene.md "$work/measured"
