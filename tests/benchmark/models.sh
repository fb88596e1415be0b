#!/usr/bin/env bash
# models.sh TOOL FOLDER...: how long `TOOL validate` takes for each mesh file of the folders, all references on: a line per file, the
# slowest first, with seconds of the processor, triangles, microseconds per triangle and the verdict. Each is the least of three runs.
set -euo pipefail
[ $# -ge 2 ] || { echo "usage: $0 TOOL FOLDER..." >&2; exit 2; }
tool=$1
shift
json=$(mktemp)
trap 'rm -f "$json"' EXIT
TIMEFORMAT='%U %S'
find "$@" -type f -regextype posix-extended -iregex '.*\.(glb|gltf|obj|fbx|dae|ply|stl)' -print0 | sort -z |
  while IFS= read -r -d '' file; do
    least=
    for _ in 1 2 3; do
      seconds=$({ time "$tool" validate "$file" --json >"$json" 2>/dev/null || true; } 2>&1 | awk '{ print $1 + $2 }')
      least=$(awk -v a="$seconds" -v b="${least:-$seconds}" 'BEGIN { print (a + 0 < b + 0 ? a : b) }')
    done
    corners=$(sed -nE 's/^          "corners": ([0-9]+),?$/\1/p' "$json" | awk '{ n += $1 } END { print n + 0 }')
    verdict=$(sed -nE 's/^  "verdict": "([a-z]+)".*/\1/p' "$json")
    awk -v s="$least" -v c="$corners" -v v="$verdict" -v f="$file" \
      'BEGIN { printf("%6.2f s %9d triangles %8.1f us each  %-12s %s\n", s, c / 3, (c > 0 ? 3e6 * s / c : 0), v, f) }'
  done | sort -rn
