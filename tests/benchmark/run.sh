#!/usr/bin/env bash
# run.sh [--quick]: builds the benchmark in build/benchmark, runs it, and writes the measured part of
# docs/reports/evaluation.md, docs/reports/work-precision.csv and work-precision.svg. Takes under ten minutes beside the
# build; the machine should do nothing else. With --quick under two, few rounds, and all three go to build/benchmark/quick.
# Needs what .ci/packages lists as build and benchmark (.ci/install build benchmark); OCCT may be absent.
set -euo pipefail
export LC_ALL=C
cd "$(dirname "$0")/../.."
quick=() out=docs/reports
case ${1:-} in
  "") ;;
  --quick) quick=(--quick) out=build/benchmark/quick ;;
  *) echo "usage: tests/benchmark/run.sh [--quick]" >&2; exit 2 ;;
esac
command -v gnuplot >/dev/null || { echo "run.sh: gnuplot is not there: .ci/install build benchmark" >&2; exit 1; }

cmake -S . -B build/benchmark -G Ninja -DCMAKE_BUILD_TYPE=Release -DDARBOUX_BUILD_TESTS=OFF -DDARBOUX_BUILD_TOOL=OFF \
  -DDARBOUX_BUILD_BENCHMARKS=ON >/dev/null
cmake --build build/benchmark --target benchmark_evaluation benchmark_work_precision
mkdir -p "$out"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

from_lscpu() {
  lscpu | sed -nE "s/^ *$1: +//p" | head -n 1
}
compiler=$(sed -nE 's/^CMAKE_CXX_COMPILER:[A-Z]+=//p' build/benchmark/CMakeCache.txt)
load=$(cut -d ' ' -f 1 /proc/loadavg)
started=$SECONDS
build/benchmark/bin/benchmark_evaluation --table "${quick[@]}" >"$work/tables"
build/benchmark/bin/benchmark_work_precision "${quick[@]}" >"$work/work-precision.csv"
cp "$work/work-precision.csv" "$out/work-precision.csv"
gnuplot -e "data='$out/work-precision.csv'; picture='$out/work-precision.svg'" tests/benchmark/work_precision.gp

{
  echo
  echo "- date: $(date -u +%F)"
  echo "- machine: $(from_lscpu 'Model name'), $(nproc) cores; L1d $(from_lscpu 'L1d cache'), L2 $(from_lscpu 'L2 cache')," \
    "L3 $(from_lscpu 'L3 cache') (all cores together)"
  echo "- load before: $load"
  echo "- system: $(uname -sr), transparent huge pages" \
    "$(sed -nE 's/.*\[(.*)\].*/\1/p' /sys/kernel/mm/transparent_hugepage/enabled 2>/dev/null || true)"
  echo "- compiler: $("$compiler" --version | head -n 1)"
  echo "- time: $((SECONDS - started)) s"
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

# The report with what is between the marks replaced.
awk -v measured="$work/measured" '
  /<!-- measured: begin -->/ { print; while ((getline line < measured) > 0) print line; inside = 1 }
  /<!-- measured: end -->/ { inside = 0 }
  !inside' docs/reports/evaluation.md >"$work/report"
grep -q '<!-- measured: begin -->' "$work/report" && grep -q '<!-- measured: end -->' "$work/report" ||
  { echo "run.sh: docs/reports/evaluation.md has no measured part" >&2; exit 1; }
cp "$work/report" "$out/evaluation.md"
echo "written: $out/evaluation.md, work-precision.csv, work-precision.svg"
grep -c 'missed\*\*' "$out/evaluation.md" | sed 's/$/ rows of the targets are missed/' || true
