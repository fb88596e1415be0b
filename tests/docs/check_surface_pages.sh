#!/usr/bin/env bash
# check_surface_pages.sh SOURCE TOOL: docs/surfaces holds what `TOOL surfaces --pages` writes: the same files, byte for
# byte, and no others.
set -euo pipefail
export LC_ALL=C
root=$1 tool=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$tool" surfaces --pages "$work/surfaces"
count=$(find "$work/surfaces" -name '*.md' | wc -l)
((count > 1)) || { echo "FAILED: the tool wrote no pages" >&2; exit 1; }
if ! diff -r "$root/docs/surfaces" "$work/surfaces" >"$work/difference"; then
  head -n 40 "$work/difference" | cut -c 1-300 >&2
  echo "FAILED: docs/surfaces is stale. Build the tool, delete files that belong to no surface, and run" >&2
  echo "  build/release/bin/darboux surfaces --pages docs/surfaces" >&2
  exit 1
fi
echo "$count pages, all up to date"
