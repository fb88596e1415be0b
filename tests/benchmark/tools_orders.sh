#!/usr/bin/env bash
# tools_orders.sh BENCHMARK_TOOLS WORK: whether the tangents of other people's tools have the orders that were measured
# earlier (tools/earlier.csv), on the same meshes. Exit status 77, a skip, where the tools cannot be had.
set -euo pipefail
tools=$1 work=$2
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../support/npm.sh"
unchecked="the orders of other tools are not held"
command -v node >/dev/null || skip "node is not there"
command -v npm >/dev/null || skip "npm is not there"
mkdir -p "$work/npm"
cp "$here"/tools/{package.json,make.mjs} "$work/npm"
if ! cmp -s "$here/tools/package-lock.json" "$work/npm/installed"; then
  cp "$here/tools/package-lock.json" "$work/npm"
  npm ci --silent --no-audit --no-fund --ignore-scripts --prefix "$work/npm" >/dev/null 2>&1 || skip "npm cannot install them"
  cp "$here/tools/package-lock.json" "$work/npm/installed"
fi
rm -rf "$work/meshes"
mkdir -p "$work/meshes"
"$tools" "$work/meshes" "node $work/npm/make.mjs" "$here/tools" --check
rm -rf "$work/meshes"
