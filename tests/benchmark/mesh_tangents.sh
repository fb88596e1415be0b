#!/usr/bin/env bash
# mesh_tangents.sh [--quick]: builds the benchmark of mesh tangents in build/benchmark, installs the npm packages that it compares
# with in build/benchmark/node, runs it, and writes the measured part of docs/reports/mesh-tangents.md. Takes about twenty minutes
# beside the build, 8 GB of memory and 2 GB of disk; the machine should do nothing else. With --quick about a minute, small
# meshes, and the report goes to build/benchmark/quick.
# Needs what .ci/packages lists as build and benchmark; without node or npm the report says what was not compared.
set -euo pipefail
. "$(dirname "$0")/common.sh"

build benchmark_mesh_tangents
packages=(mikktspace@1.1.1 meshoptimizer@1.3.0)
node="node tests/benchmark/mesh_tangents.mjs build/benchmark/node" versions="node $(node --version 2>/dev/null || true)"
if ! command -v node >/dev/null; then
  node="-node is not there"
elif ! command -v npm >/dev/null; then
  node="-npm is not there"
elif ! npm install --silent --no-audit --no-fund --prefix build/benchmark/node "${packages[@]}" >"$work/npm" 2>&1; then
  cat "$work/npm" >&2
  node="-npm cannot install ${packages[*]}"
fi
[[ $node != -* ]] || versions=${node#-}

start
build/benchmark/bin/benchmark_mesh_tangents --table "$work" "$node" "${quick[@]}" >"$work/tables"
{
  echo
  circumstances
  echo "- npm: ${packages[*]}; $versions"
  cat "$work/tables"
  echo
} >"$work/measured"
write_report mesh-tangents.md "$work/measured"
