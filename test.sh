#!/usr/bin/env bash
# Installs what is missing, builds, and passes the tests. Runs from anywhere, and again.
#   ./test.sh            the release build and all its tests
#   ./test.sh PRESET     one preset of CMakePresets.json with its tests: release, debug, asan, clang
#   ./test.sh tidy       clang-tidy by .clang-tidy over all of src and the headers it reads; half an hour of one core
set -euo pipefail
cd "$(dirname "$0")"
.ci/install build test
check() {
  cmake --preset "$1" -DDARBOUX_BUILD_TESTS=ON -DDARBOUX_THIS_MACHINE=ON
  cmake --build --preset "$1"
  local jobs=$(($(nproc) + 1))  # some tests wait: for signals, browsers, disks
  ctest --preset "$1" -j $((jobs < 9 ? jobs : 9))
}
if [ "$*" = tidy ]; then
  .ci/install tidy
  cmake --preset clang -B build/tidy -DDARBOUX_BUILD_TESTS=OFF
  exec tests/tree/check_tidy.sh build/tidy
fi
if [ $# -gt 0 ]; then
  for preset in "$@"; do check "$preset"; done
  exit
fi
check release
