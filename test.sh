#!/usr/bin/env bash
# Installs what is missing, builds, and passes the tests. Runs from anywhere, and again.
#   ./test.sh            the release build and all its tests, after clang has read every source of library and tool without
#                        warnings (it generates no code: ./test.sh clang does, of each source alone, and passes the tests)
#   ./test.sh PRESET     one preset of CMakePresets.json with its tests: release, debug, asan, clang
#   ./test.sh tidy       clang-tidy by .clang-tidy over all of src and the headers it reads; half an hour of one core
set -euo pipefail
cd "$(dirname "$0")"
.ci/install build test
check() {
  cmake --preset "$1" -DDARBOUX_BUILD_TESTS=ON
  cmake --build --preset "$1"
  ctest --preset "$1" -j 2
}
read_only=build/clang-syntax
if [ "$*" = tidy ]; then
  .ci/install tidy
  cmake --preset clang -B "$read_only" -DDARBOUX_BUILD_TESTS=OFF
  exec tests/tree/check_tidy.sh "$read_only"
fi
if [ $# -gt 0 ]; then
  for preset in "$@"; do check "$preset"; done
  exit
fi
cmake --preset clang -B "$read_only" -DDARBOUX_BUILD_TESTS=OFF -DDARBOUX_BUILD_TOGETHER=ON
# A second time: CMake must find a compiler that works. After -Xclang the flag leaves precompiled headers as they are. Nothing
# is left to archive.
cmake -B "$read_only" "-DCMAKE_CXX_FLAGS=-Xclang -fsyntax-only" -DCMAKE_CXX_ARCHIVE_CREATE=true -DCMAKE_CXX_ARCHIVE_FINISH=true
# Not the public headers alone: a test of the release build compiles those.
ninja -C "$read_only" -t targets all | sed -n '/verify_interface_header_sets/d; s/^\(.*\.o\): .*/\1/p' | xargs ninja -C "$read_only"
check release
