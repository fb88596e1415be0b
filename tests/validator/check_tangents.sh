#!/usr/bin/env bash
# check_tangents.sh TOOL WRITER DATA SHARED WORK: whether the Khronos validator finds errors in what `TOOL tangents` writes
# that it does not find in what it reads: the .glb files of DATA and, where it is there, of the folders of SHARED, and the one
# that WRITER writes. Exit status 77, a skip, where node or the validator cannot be had.
set -euo pipefail
tool=$1 writer=$2 data=$3 shared=$4 work=$5
here=$(cd "$(dirname "$0")" && pwd)
skip() {
  echo "SKIPPED: $1; files are not validated"
  exit 77
}
command -v node >/dev/null || skip "node is not there"
version=2.0.0-dev.3.10
mkdir -p "$work"
if [ ! -d "$work/node_modules/gltf-validator" ]; then
  command -v npm >/dev/null || skip "npm is not there"
  npm install --silent --no-audit --no-fund --prefix "$work" "gltf-validator@$version" >/dev/null 2>&1 ||
    skip "npm cannot install gltf-validator@$version"
fi
[ -d "$shared" ] || echo "$shared is not here: the files of other tools in it are not validated"
rm -rf "$work/in" "$work/out"
mkdir -p "$work/in" "$work/out"
"$writer" "$work/in/generated.glb"
shopt -s nullglob
for file in "$data"/*.glb "$shared"/*/*.glb; do cp "$file" "$work/in/"; done
for file in "$work"/in/*.glb; do
  status=0
  "$tool" tangents "$file" -o "$work/out/$(basename "$file")" --quiet || status=$?
  [ "$status" -le 1 ] || { echo "FAILED: status $status of $file"; exit 1; }
done
NODE_PATH=$work/node_modules node "$here/compare_errors.js" "$work/in" "$work/out"
