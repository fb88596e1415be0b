#!/usr/bin/env bash
# determinism.sh TOOL [TOOL ...]: what the commands write is the same to the bit over runs, threads, instruction sets, locales and
# time zones, and over the tools given: built by other compilers, for debugging, in another folder. Left out are seconds, dates and
# what a build says of itself. Exit 1 where something differs; the table is printed as docs/reports/determinism.md has it.
set -uo pipefail
tests=$(cd "$(dirname "$0")" && pwd)
tools=()
for tool in "$@"; do tools+=("$(realpath "$tool")"); done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
ln -s "$tests/data" data
printf '0.25,0.5\n0.123456789,0.987654321\n-3,7\n' >uv.csv

commands=(
  "eval, every surface|for s in \$(\"\$T\" surfaces --json | sed -nE 's/^      \"name\": \"(.*)\",/\1/p' ); do \"\$T\" eval \$s --grid 24x16 --format f64 THREADS --attributes position,dpdu,dpdv,d2pdu2,d2pduv,d2pdv2,tangent,bitangent,normal,tangent4,gaussian_curvature,principal_curvatures,christoffel; done"
  "eval as text|\"\$T\" eval torus --input uv.csv --format csv THREADS --attributes position,tangent,normal; \"\$T\" eval ellipsoid:semi_axis_x=3 --grid 4x4 --json THREADS"
  "mesh|\"\$T\" mesh torus --grid 48x24 -o o.glb && cat o.glb"
  "tangents, each method|for m in mikktspace face average unit area angle max; do \"\$T\" tangents data/torus_016.none.glb --method \$m THREADS -o o.glb --quiet >/dev/null && cat o.glb; done"
  "validate|\"\$T\" validate --json THREADS data/torus_032.three.glb data/sphere_032.mikk.glb data/cone_016.three.glb data/torus_016.obj"
  "fit|\"\$T\" fit data/torus_points.xyz --json --frames f.csv THREADS && cat f.csv"
  "converge|\"\$T\" converge --surfaces torus --meshes regular,jittered --resolutions 8..32 --json THREADS"
  "compare|\"\$T\" compare data/torus_032.three.glb data/torus_032.mikk.glb --json THREADS"
  "plan|\"\$T\" plan data/torus_016.three.glb --json THREADS"
  "scene|\"\$T\" scene $tests/../docs/examples/scene.json --json"
)
# sums TOOL [VARIABLE=VALUE ...]: a line for each command.
sums() {
  local tool=$1
  shift
  for command in "${commands[@]}"; do
    rm -f o.glb f.csv
    env "$@" T="$tool" bash -c "${command#*|}" 2>err | sed -zE "$timeless" | sha256sum | cut -c1-16
    [ ! -s err ] || { echo "${command%%|*}: $(head -1 err)" >&2; }
  done
}
timeless='s,"threads": [0-9]+,,g;s/"[a-z_]*(seconds|_ms|_ns|per_s|date|time|started|host|machine|compiler|commit|version|build)[a-z_]*": (\[[^]]*\]|\{[^}]*\}|"[^"]*"|[^],}\n]*)//g'
failed=0
rows=()
compare() {  # compare VARIANT FILE
  local row="| $1 |" i=0
  while read -r expected && read -r got <&3; do
    if [ "$expected" = "$got" ]; then row+=" = |"; else
      row+=" **≠** |"
      failed=1
      echo "FAILED: ${commands[$i]%%|*}: other bits: $1" >&2
    fi
    i=$((i + 1))
  done <first 3<"$2"
  rows+=("$row")
}
with_threads() {  # with_threads N: the commands with so many
  commands=("${templates[@]//THREADS/--threads $1}")
}
templates=("${commands[@]}")
with_threads 1
sums "${tools[0]}" >first
[ "$(sort -u first | wc -l)" = "${#commands[@]}" ] || { echo "FAILED: two commands wrote the same: $(cat first)" >&2; exit 1; }
variant() {
  local name=$1
  shift
  sums "$@" >got
  compare "$name" got
}
variant "another run" "${tools[0]}"
for threads in 2 3 7; do
  with_threads $threads
  variant "$threads threads" "${tools[0]}"
done
with_threads 1
for set in baseline avx2 avx512; do
  if DARBOUX_ISA=$set "${tools[0]}" eval sphere --at 0,0 >/dev/null 2>&1; then
    variant "instructions: $set" "${tools[0]}" DARBOUX_ISA=$set
  else
    echo "SKIPPED: this machine has no $set"
  fi
done
# A locale whose decimals have a comma: one of the machine's, or made here.
comma=$(locale -a 2>/dev/null | grep -iE '^(de|fr|es|it|pt|ru|sv)_' | head -1)
if [ -z "$comma" ] && localedef -i de_DE -f UTF-8 ./de_DE.UTF-8 2>/dev/null; then comma=de_DE.UTF-8; export LOCPATH=$work; fi
if [ -n "$comma" ]; then
  variant "locale $comma" "${tools[0]}" LC_ALL="$comma" LANG="$comma"
else
  echo "SKIPPED: there is no locale with decimal commas"
fi
variant "time zone Asia/Kathmandu" "${tools[0]}" TZ=Asia/Kathmandu
for tool in "${tools[@]:1}"; do variant "$tool" "$tool"; done
echo "|  |$(printf ' %s |' "${templates[@]%%|*}")"
echo "|---|$(printf -- '---|%.0s' "${templates[@]}")"
printf '%s\n' "${rows[@]}"
exit $failed
