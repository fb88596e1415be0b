#!/usr/bin/env bash
# tools.sh [--quick]: builds what judges the tangents of other tools in build/benchmark, installs the npm packages that
# tests/benchmark/tools/package-lock.json pins in build/benchmark/tools, runs them, and writes the measured part of
# docs/reports/tools.md. Takes about four minutes beside the build, 0.6 GB of memory and of disk. With --quick a quarter of a minute, coarse
# meshes, and the report goes to build/benchmark/quick.
# Needs what .ci/packages lists as build and benchmark, node (20 was used) with npm, and what npm has. The sample models are those
# of ../shared/meshes/khronos; without them their table says so.
set -euo pipefail
. "$(dirname "$0")/common.sh"

for program in node npm; do
  command -v "$program" >/dev/null || { echo "$0: $program is not there; the tools compared run in node" >&2; exit 1; }
done
build benchmark_tools
node_folder=build/benchmark/tools
mkdir -p "$node_folder"
cp tests/benchmark/tools/{package.json,package-lock.json,make.mjs} "$node_folder"
npm ci --silent --no-audit --no-fund --ignore-scripts --prefix "$node_folder" >"$work/npm" 2>&1 ||
  { cat "$work/npm" >&2; echo "$0: npm cannot install what $node_folder/package-lock.json names" >&2; exit 1; }

start
build/benchmark/bin/benchmark_tools "$work" "node $node_folder/make.mjs" ../shared/meshes/khronos tests/benchmark/tools \
  tests/data "${quick[@]}" >"$work/tables"
{
  echo
  circumstances
  npm_packages=$(sed -nE 's/^ *"([@a-z/-]+)": "([0-9.]+)",?$/\1@\2/p' "$node_folder/package.json" | paste -sd ' ')
  echo "- npm: $npm_packages; node $(node --version)"
  cat "$work/tables"
  echo
} >"$work/measured"
write_report tools.md "$work/measured"
