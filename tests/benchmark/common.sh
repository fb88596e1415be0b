# What run.sh, mesh_tangents.sh, scene.sh, tools.sh and validate.sh share; they source it with their arguments. It goes to the root of the repository and sets
# quick (the option, or nothing), out (the folder of the report) and work (an empty folder, removed at the end).
export LC_ALL=C
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
quick=() out=docs/reports
case ${1:-} in
  "") ;;
  --quick) quick=(--quick) out=build/benchmark/quick ;;
  *) echo "usage: $0 [--quick]" >&2; exit 2 ;;
esac
mkdir -p build/benchmark "$out"
work=$(mktemp -d build/benchmark/work.XXXXXX)
trap 'rm -rf "$work"' EXIT

# build TARGET...
build() {
  cmake -S . -B build/benchmark -G Ninja -DCMAKE_BUILD_TYPE=Release -DDARBOUX_BUILD_TESTS=OFF -DDARBOUX_BUILD_TOOL=OFF \
    -DDARBOUX_BUILD_BENCHMARKS=ON >/dev/null
  cmake --build build/benchmark --target "$@"
}

# Before anything is measured.
start() {
  load=$(cut -d ' ' -f 1 /proc/loadavg)
  started=$SECONDS
}

from_lscpu() {
  lscpu | sed -nE "s/^ *$1: +//p" | head -n 1
}
# When and where it was measured, as a list. After all is measured.
circumstances() {
  local compiler
  compiler=$(sed -nE 's/^CMAKE_CXX_COMPILER:[A-Z]+=//p' build/benchmark/CMakeCache.txt)
  echo "- date: $(date -u +%F)"
  echo "- machine: $(from_lscpu 'Model name'), $(nproc) cores; L1d $(from_lscpu 'L1d cache'), L2 $(from_lscpu 'L2 cache')," \
    "L3 $(from_lscpu 'L3 cache') (all cores together)"
  echo "- load before: $load"
  echo "- system: $(uname -sr), transparent huge pages" \
    "$(sed -nE 's/.*\[(.*)\].*/\1/p' /sys/kernel/mm/transparent_hugepage/enabled 2>/dev/null || true)"
  echo "- compiler: $("$compiler" --version | head -n 1)"
  echo "- time: $((SECONDS - started)) s"
}

# write_report NAME MEASURED: the report docs/reports/NAME with what is between its marks replaced by a file, to $out.
write_report() {
  awk -v measured="$2" '
    /<!-- measured: begin -->/ { print; while ((getline line < measured) > 0) print line; inside = 1 }
    /<!-- measured: end -->/ { inside = 0 }
    !inside' "docs/reports/$1" >"$work/report"
  grep -q '<!-- measured: begin -->' "$work/report" && grep -q '<!-- measured: end -->' "$work/report" ||
    { echo "$0: docs/reports/$1 has no measured part" >&2; exit 1; }
  cp "$work/report" "$out/$1"
  echo "written: $out/$1"
  grep -c 'missed\*\*' "$out/$1" | sed 's/$/ rows of the targets are missed/' || true
}
