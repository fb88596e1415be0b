#!/usr/bin/env bash
# Installs what is missing, builds, and passes the tests. Runs from anywhere, and again.
#   ./test.sh            the release build and all its tests, after a clang build of library and tool without warnings
#   ./test.sh PRESET     one preset of CMakePresets.json with its tests: release, debug, asan, clang
set -euo pipefail
cd "$(dirname "$0")"
.ci/install build test
check() {
  cmake --preset "$1" -DDARBOUX_BUILD_TESTS=ON
  cmake --build --preset "$1"
  ctest --preset "$1" -j 2
}
if [ $# -gt 0 ]; then
  for preset in "$@"; do check "$preset"; done
  exit
fi
cmake --preset clang -DDARBOUX_BUILD_TESTS=OFF
cmake --build --preset clang
check release
