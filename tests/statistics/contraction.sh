#!/usr/bin/env bash
# contraction.sh: how far the points of a program that the compiler may contract, a*b+c to one rounding (-O3 -march=native, where
# neither CMake's target nor pkg-config sets -ffp-contract=off), are from the library's own. Writes docs/reports/contraction.md's
# table. A minute; needs Eigen and a machine with FMA.
set -euo pipefail
cd "$(dirname "$0")/../.."
compiler=${CXX:-g++} work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
grep -qw fma /proc/cpuinfo || { echo "this machine has no FMA: nothing would be contracted" >&2; exit 1; }
build() {  # build NAME OPTION...
  "$compiler" -std=c++20 "${@:2}" -Iinclude -Isurfaces -Isrc -isystem /usr/include/eigen3 tests/statistics/contraction.cpp \
    src/surface/refusals.cpp -o "$work/$1"
}
build plain -O2 -ffp-contract=off
build contracted -O3 -march=native -DEIGEN_MAX_ALIGN_BYTES=16 -DEIGEN_MALLOC_ALREADY_ALIGNED=1
"$work/plain" "$work/a"
"$work/contracted" "$work/b"
report=docs/reports/contraction.md
{
  sed '/<!-- measured: begin -->/q' "$report"
  echo
  echo "- date: $(date -u +%F)"
  echo "- machine: $(lscpu | sed -nE 's/^ *Model name: +//p' | head -n 1)"
  echo "- compiler: $("$compiler" --version | head -n 1)"
  echo
  "$work/plain" --compare "$work/a" "$work/b"
  echo
  sed -n '/<!-- measured: end -->/,$p' "$report"
} >"$work/report"
mv "$work/report" "$report"
