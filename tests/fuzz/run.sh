#!/usr/bin/env bash
# Builds the fuzz targets (preset fuzz) and runs each on its corpus, under the address and undefined-behaviour
# sanitizers.
#   tests/fuzz/run.sh [SECONDS [TARGET ...]]     10 seconds of each target unless said otherwise
# Exit 1 where one finds something, which is written to build/fuzz/found/. What adds coverage goes to
# build/fuzz/corpus/TARGET, and from there, minimised, with KEEP=1 into tests/fuzz/corpus: at most 64 files of at
# most 4096 bytes each. BUILD=0 runs what is built.
set -euo pipefail
cd "$(dirname "$0")/../.."
seconds=${1:-10}
shift || true
if [ "${BUILD:-1}" = 1 ]; then
  cmake --preset fuzz > /dev/null
  cmake --build --preset fuzz --target fuzz_targets > /dev/null
fi
targets=("$@")
if [ ${#targets[@]} -eq 0 ]; then
  for program in build/fuzz/bin/fuzz_*; do targets+=("${program##*/fuzz_}"); done
fi
mkdir -p build/fuzz/found
export ASAN_OPTIONS=detect_leaks=1:allocator_may_return_null=0 UBSAN_OPTIONS=print_stacktrace=1
failed=0
printf '%-16s %12s %10s %8s  %s\n' target executions features corpus result
for target in "${targets[@]}"; do
  grown=build/fuzz/corpus/$target
  seeds=tests/fuzz/corpus/${target%_decoders}  # gltf and gltf_decoders read the same files
  mkdir -p "$grown" "$seeds"
  log=build/fuzz/$target.log
  result=ok
  build/fuzz/bin/fuzz_"$target" -max_total_time="$seconds" -timeout=25 -rss_limit_mb=2048 -max_len=4096 -print_final_stats=1 \
    -artifact_prefix=build/fuzz/found/"$target"- "$grown" "$seeds" > "$log" 2>&1 || result=FOUND
  if [ $result = FOUND ]; then failed=1; fi
  printf '%-16s %12s %10s %8s  %s\n' "$target" "$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")" \
    "$(grep -o 'ft: [0-9]*' "$log" | tail -1 | cut -d' ' -f2)" "$(find "$grown" "$seeds" -type f | wc -l)" "$result"
  if [ "${KEEP:-0}" = 1 ] && [ $result = ok ]; then
    least=$(mktemp -d)
    build/fuzz/bin/fuzz_"$target" -merge=1 -max_len=4096 "$least" "$seeds" "$grown" > /dev/null 2>&1
    find "$least" -type f -printf '%s %p\n' | sort -n | head -64 | cut -d' ' -f2 | xargs -I{} cp -n {} "$seeds"
    rm -r "$least"
  fi
done
exit $failed
