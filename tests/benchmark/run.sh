#!/usr/bin/env bash
# run.sh [--quick]: builds the benchmark in build/benchmark, runs it, and writes the measured part of
# docs/reports/evaluation.md, docs/reports/work-precision.csv and work-precision.svg. Takes under ten minutes beside the
# build; the machine should do nothing else. With --quick under two, few rounds, and all three go to build/benchmark/quick.
# Needs what .ci/packages lists as build and benchmark (.ci/install build benchmark); OCCT may be absent.
set -euo pipefail
. "$(dirname "$0")/common.sh"
command -v gnuplot >/dev/null || { echo "run.sh: gnuplot is not there: .ci/install build benchmark" >&2; exit 1; }

build benchmark_evaluation benchmark_work_precision
start
build/benchmark/bin/benchmark_evaluation --table "${quick[@]}" >"$work/tables"
build/benchmark/bin/benchmark_work_precision "${quick[@]}" >"$work/work-precision.csv"
cp "$work/work-precision.csv" "$out/work-precision.csv"
gnuplot -e "data='$out/work-precision.csv'; picture='$out/work-precision.svg'" tests/benchmark/work_precision.gp

{
  echo
  circumstances
  cat "$work/tables"
  echo
  echo "### Time against error"
  echo
  echo "[All surfaces, as data](work-precision.csv): median nanoseconds a point, largest error of a component of t, b, n, and"
  echo "of position and partials relative to the longest of each."
  echo
  echo "![Nanoseconds a point against largest error](work-precision.svg)"
  echo
} >"$work/measured"
write_report evaluation.md "$work/measured"
echo "written: $out/work-precision.csv, work-precision.svg"
