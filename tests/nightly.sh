#!/usr/bin/env bash
# nightly.sh [STEP ...]: what takes too long for every landing. Each step prints what it did; its last lines
# are kept in build/nightly/STEP.log, and build/nightly/results has a line per step: when, commit, step,
# passed or FAILED, seconds. Exit 1 where one failed.
#   long          the release build's suite, with all repetitions of laws and statistics: a landing takes a half to a sixth
#   address       the whole suite under the address and undefined-behaviour sanitizers
#   threads       what runs in parallel under the thread sanitizer
#   clang         clang compiles every source of src and every public header alone, without a warning
#   fuzz          each target of tests/fuzz for 60 seconds (FUZZ_SECONDS)
#   mutants       100 000 mutants of corpora over all formats, without sanitizers (MUTANTS)
#   kills         500 kills
#   faults        60 points of failure per call and command, one allocation from each stack of the tool's own
#                 functions, and memory that is lost there: an hour and a half
#   determinism   release, debug and clang give the same bits
#   reproducible  two builds in two folders give the same bytes
#   coverage      lines and branches
set -uo pipefail
cd "$(dirname "$0")/.."
mkdir -p build/nightly
steps=("$@")
[ $# -gt 0 ] || steps=(long address threads clang fuzz mutants kills faults determinism reproducible coverage)
build() {  # build PRESET TARGET ...
  local preset=$1
  shift
  cmake --preset "$preset" >/dev/null && cmake --build --preset "$preset" --target "$@" >/dev/null
}
long() { build release all && DARBOUX_LONG_TESTS=1 ctest --preset release -j 2; }
address() { build asan all && ctest --preset asan -j 2; }
threads() {
  build tsan base_tests evaluate_tests mesh_tests darboux_tool || return 1
  export TSAN_OPTIONS="suppressions=$PWD/tests/thread_sanitizer.txt halt_on_error=1 second_deadlock_stack=1"
  local bin=$PWD/build/tsan/bin data=$PWD/tests/data work
  work=$(mktemp -d) || return 1
  "$bin/base_tests" --gtest_filter='ParallelJobs.*' && "$bin/evaluate_tests" &&
    "$bin/mesh_tests" --gtest_filter='MikkTSpace.*:MeshFrames.*:FrameMethods.*:Fragment*' || return 1
  (
    cd "$work" || exit 1
    "$bin/darboux" eval torus --grid 300x300 --format f64 --threads 4 >o.f64 &&
      "$bin/darboux" tangents "$data/torus_016.none.glb" -o o.glb --threads 4 &&
      "$bin/darboux" fit "$data/torus_points.xyz" --frames o.csv --threads 4 &&
      "$bin/darboux" check sphere torus --points 200 --threads 4 &&
      { "$bin/darboux" validate "$data"/*.three.glb --threads 4 || [ $? = 1 ]; } &&
      "$bin/darboux" converge --surfaces torus --resolutions 8..32 --threads 4
  )
  local status=$?
  rm -rf "$work"
  return $status
}
clang() { build clang darboux_tool all_verify_interface_header_sets; }
fuzz() { tests/fuzz/run.sh "${FUZZ_SECONDS:-60}"; }
mutants() {
  build release fuzz_targets || return 1
  local target count result
  for target in gltf gltf_decoders ply stl collada pcd points formula surface_file surface_text scene_file png image \
    uv_points results baseline config study evaluate mesh_frames mikktspace fit_points; do
    count=${MUTANTS:-100000}
    [ "$target" != fit_points ] || count=$((count / 100))  # a fit of each, where others parse
    result=$(build/release/bin/fuzz_$target "tests/fuzz/corpus/${target%_decoders}" "$count") || return 1
    echo "$target: $result"
  done
}
kills() { build release cli_tests && DARBOUX_KILLS=500 build/release/bin/cli_tests --gtest_filter='Kills.NoOutputIsBroken*'; }
faults() (
  test=build/release/bin/cli_tests
  export DARBOUX_FAULTS_LEAKS=1
  build release cli_tests && DARBOUX_FAULTS=60 "$test" --gtest_filter='Faults.*-*OwnCode*' &&
    DARBOUX_FAULTS=1000000 "$test" --gtest_filter='Faults.*OwnCode*'
)
determinism() {
  build release darboux_tool && build debug darboux_tool && build clang darboux_tool &&
    tests/determinism.sh build/release/bin/darboux build/debug/bin/darboux build/clang/bin/darboux
}
reproducible() { tests/package/reproducible.sh; }
coverage() { tests/coverage.sh; }

failed=0
for step in "${steps[@]}"; do
  case $step in
    long | address | threads | clang | fuzz | mutants | kills | faults | determinism | reproducible | coverage) ;;
    *) echo "nightly.sh: expected steps that its first lines list, got $step" >&2; exit 2 ;;
  esac
  begun=$SECONDS
  if "$step" >"build/nightly/$step.log" 2>&1; then result=passed; else result=FAILED failed=1; fi
  line="$(date -u +%F) $(git rev-parse --short HEAD) $step $result $((SECONDS - begun)) s"
  echo "$line" | tee -a build/nightly/results
  [ $result = passed ] || tail -20 "build/nightly/$step.log"
done
exit $failed
