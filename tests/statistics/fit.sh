#!/usr/bin/env bash
# fit.sh [--quick]: builds the statistics of the fit of points in build/benchmark, runs them, and writes the measured part of
# docs/reports/fit.md. Takes 30 to 45 minutes on two cores beside the build; the machine should do nothing else. With --quick
# about two minutes, a twentieth of the data sets, and the report goes to build/benchmark/quick.
# Needs what .ci/packages lists as build and benchmark; without CGAL, or PCL (libpcl-dev, 1.1 GB, not in
# that list), the report says what was not compared.
set -euo pipefail
. "$(dirname "$0")/../benchmark/common.sh"

build fit_statistics benchmark_local_jets
start
build/benchmark/bin/fit_statistics "${quick[@]}" >"$work/tables"
build/benchmark/bin/benchmark_local_jets "${quick[@]}" >>"$work/tables"
{
  echo
  circumstances
  cat "$work/tables"
  echo
} >"$work/measured"
write_report fit.md "$work/measured"
