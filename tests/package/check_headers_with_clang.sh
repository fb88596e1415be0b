#!/usr/bin/env bash
# check_headers_with_clang.sh HEADERS_TOGETHER SOURCE_ROOT [PROGRAM]: clang reads a source that includes every public header, and a
# program that uses every surface, without a warning. Exit status 77, a skip, without clang.
set -euo pipefail
root=$2
command -v clang++ >/dev/null || { echo "SKIPPED: clang++ is not installed"; exit 77; }
for source in "$1" "${@:3}"; do
  clang++ -std=c++20 -fsyntax-only -Wall -Wextra -Wpedantic -Werror -I"$root/include" -I"$root/surfaces" \
    -isystem /usr/include/eigen3 "$source"
  echo "$source: no warning"
done
