#!/usr/bin/env bash
# Installs what is missing, builds, and does the main job: validates a mesh that another tool made and writes a
# convergence report. Runs from anywhere, and again.
#   ./demo.sh                      all of it
#   ./demo.sh TOOL [RESOLUTIONS]   with a tool that is built; RESOLUTIONS are those of the report, 8..128
set -euo pipefail
tool=${1:+$(realpath "$1")}
cd "$(dirname "$0")"
if [ -z "$tool" ]; then
  .ci/install build
  cmake --preset release -DDARBOUX_BUILD_TESTS=OFF -DDARBOUX_THIS_MACHINE=ON
  cmake --build --preset release --target darboux_tool
  tool=build/release/bin/darboux
fi
mkdir -p build
report=build/convergence.html
echo
echo "== The tangents three.js computed for a torus, against the truth"
"$tool" validate tests/data/torus_032.three.glb
echo
echo "== How fast mesh tangents converge to the truth"
"$tool" converge --surfaces torus --surfaces sphere --meshes regular,jittered --resolutions "${2:-8..128}" -o "$report"
echo
echo "The convergence report: $PWD/$report"
