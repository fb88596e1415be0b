#!/usr/bin/env bash
# recognition.sh [--quick]: builds the statistics of recognition in build/benchmark, runs them, and writes the measured part of
# docs/reports/recognition.md. Takes half an hour on two cores beside the build. With --quick two minutes, a
# twentieth of the meshes, and the report goes to build/benchmark/quick.
set -euo pipefail
. "$(dirname "$0")/../benchmark/common.sh"

build recognition_statistics
start
build/benchmark/bin/recognition_statistics "${quick[@]}" >"$work/tables"
{
  echo
  circumstances
  cat "$work/tables"
  echo
} >"$work/measured"
write_report recognition.md "$work/measured"
