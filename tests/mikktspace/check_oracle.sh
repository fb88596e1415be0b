#!/usr/bin/env bash
# check_oracle.sh WRITER STORED WORK: whether the npm package mikktspace gives the tangents that are stored for the meshes of
# generated_meshes.h. Exit status 77, a skip, where node or the package cannot be had.
set -euo pipefail
writer=$1 stored=$2 work=$3
here=$(cd "$(dirname "$0")" && pwd)
skip() {
  echo "SKIPPED: $1; the stored tangents alone are compared with"
  exit 77
}
command -v node >/dev/null || skip "node is not there"
mkdir -p "$work"
if [ ! -d "$work/node_modules/mikktspace" ]; then
  command -v npm >/dev/null || skip "npm is not there"
  npm install --silent --no-audit --no-fund --prefix "$work" mikktspace@1.1.1 >/dev/null 2>&1 ||
    skip "npm cannot install mikktspace@1.1.1"
fi
"$writer" "$work/meshes"
NODE_PATH=$work/node_modules node "$here/oracle.js" "$work/meshes" "$work/tangents"
cmp "$work/tangents" "$stored"
