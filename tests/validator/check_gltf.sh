#!/usr/bin/env bash
# check_gltf.sh TOOL WRITER DATA SHARED WORK: whether the Khronos validator finds errors in what `TOOL tangents` and `TOOL validate
# --paint` write that it does not find in what they read: the .glb files of DATA and, where it is there, of the folders of SHARED,
# and the one that WRITER writes; of what is painted from another format, any error. Exit status 77, a skip, where node or the
# validator cannot be had.
set -euo pipefail
tool=$1 writer=$2 data=$3 shared=$4 work=$5
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../support/npm.sh"
unchecked="files are not validated"
need_npm "$work" gltf-validator@2.0.0-dev.3.10
[ -d "$shared" ] || echo "$shared is not here: the files of other tools in it are not validated"
rm -rf "$work"/{in,tangents,painted}
mkdir -p "$work"/{in,tangents,painted}
"$writer" "$work/in/generated.glb"
shopt -s nullglob
for file in "$data"/*.{glb,obj} "$shared"/*/*.{glb,obj}; do cp "$file" "$work/in/"; done

writes() {  # writes FILE ARGUMENT...: runs the tool, whose verdict may be no, but which must write FILE
  local file=$1 status=0
  shift
  "$tool" "$@" >/dev/null || status=$?
  [ "$status" -le 1 ] && [ -s "$file" ] || { echo "FAILED: status $status of $*"; exit 1; }
}
for file in "$work"/in/*; do
  name=$(basename "$file")
  painted=$work/painted/${name/%.obj/.obj.glb}
  writes "$painted" validate "$file" --paint "$painted"
  case $name in *.glb) writes "$work/tangents/$name" tangents "$file" -o "$work/tangents/$name" --quiet ;; esac
done
status=0
for written in tangents painted; do
  echo "$written:"
  node "$here/compare_errors.js" "$work/in" "$work/$written" || status=1
done
exit $status
