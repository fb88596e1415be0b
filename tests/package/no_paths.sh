#!/usr/bin/env bash
# no_paths.sh FOLDER FILE ...: none of the files, of a release build, holds the name of the folder that it
# was built in: a build elsewhere would give other bytes. tests/package/reproducible.sh compares all of
# them.
set -euo pipefail
folder=$1
shift
for file in "$@"; do
  [ -s "$file" ] || { echo "FAILED: expected a file that was built, got none: $file" >&2; exit 1; }
  if grep -qaF "$folder" "$file"; then
    echo "FAILED: $file holds $folder: $(strings -a "$file" | grep -F -m1 "$folder")" >&2
    exit 1
  fi
done
echo "$# files without $folder"
