#!/usr/bin/env bash
# exporters.sh [TOOL]: has Blender make and export some 3000 models (exporters.py), three.js (npm) some 1200 (exporters_three.mjs), and
# gltf-transform (npm) quantise and optimise some of Blender's glTF, validates all of them, and writes the measured part of
# docs/reports/exporters.md: how many pass, and what those that fail are said to have. Needs blender, python3-numpy and npm, which
# .ci/packages does not list. Five minutes.
set -euo pipefail
tool=$(realpath "${1:-$(dirname "$0")/../../build/release/bin/darboux}")
set --  # common.sh knows other arguments
. "$(dirname "$0")/../benchmark/common.sh"

work=$PWD/$work
mkdir -p "$work/blender" "$work/three" "$work/quantize" "$work/optimize"
blender -b --python tests/statistics/exporters.py -- "$work/blender" >"$work/log" 2>&1
grep -q "Blender quit" "$work/log" || { tail -5 "$work/log" >&2; exit 2; }
packages=(@gltf-transform/cli@4.5.1 three@0.187.0 mikktspace@1.1.1 three-subdivide@1.1.5)
npm install --silent --no-audit --no-fund --legacy-peer-deps --prefix "$work/node" "${packages[@]}"
cp tests/statistics/exporters_three.mjs "$work/node"  # which finds its packages from where it lies
node --no-deprecation "$work/node/exporters_three.mjs" "$work/three"
for file in "$work"/blender/*_{smooth,auto,smart,scaled,bevelled,decimated}.applied.glb; do
  for command in quantize optimize; do
    "$work/node/node_modules/.bin/gltf-transform" "$command" "$file" "$work/$command/$(basename "$file")" >/dev/null 2>&1 || true
  done
done
for from in blender three quantize optimize; do
  "$tool" validate "$work/$from" --json >"$work/$from.json" || [ $? = 1 ]
done
{
  echo
  echo "- date: $(date -u +%F)"
  echo "- $(blender --version | head -1); ${packages[*]}"
  echo "- $("$tool" --version)"
  echo
  python3 tests/statistics/exporters_table.py "$work"/{blender,three,quantize,optimize}.json
  echo
} >"$work/measured"
write_report exporters.md "$work/measured"
