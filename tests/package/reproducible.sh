#!/usr/bin/env bash
# reproducible.sh [TARGET ...]: builds this commit twice, in two folders whose paths have other lengths, and
# compares the bytes of libraries and tool: darboux, darboux_fit, darboux_io and darboux_tool unless targets
# are named. Exit 1 where they differ. Two whole builds: for the nightly script.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
targets=("$@")
[ $# -gt 0 ] || targets=(darboux darboux_fit darboux_io darboux_tool)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export CCACHE_DISABLE=1
for folder in "$work/a" "$work/another/and/longer"; do
  mkdir -p "$folder"
  git -C "$root" archive HEAD | tar -x -C "$folder"
  cmake --preset release -S "$folder" -B "$folder/build/release" -DDARBOUX_BUILD_TESTS=OFF >"$work/log" 2>&1 ||
    { tail -5 "$work/log" >&2; exit 2; }
  cmake --build "$folder/build/release" --target "${targets[@]}" >"$work/log" 2>&1 || { grep -m5 error "$work/log" >&2; exit 2; }
  (cd "$folder/build/release" && find . -name '*.a' -o -name '*.so*' -type f -o -path ./bin/darboux | sort | xargs sha256sum) >>"$work/sums"
done
[ -s "$work/sums" ] || { echo "FAILED: expected libraries, got none" >&2; exit 1; }
failed=0
for file in $(awk '{print $2}' "$work/sums" | sort -u); do
  if [ "$(grep " $file\$" "$work/sums" | sort -u | wc -l)" = 1 ] && [ "$(grep -c " $file\$" "$work/sums")" = 2 ]; then
    echo "same bytes: $file"
  else
    echo "FAILED: $file differs" >&2
    failed=1
  fi
done
exit $failed
