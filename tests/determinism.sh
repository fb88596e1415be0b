#!/usr/bin/env bash
# determinism.sh TOOL [TOOL ...]: what the commands write is the same to the bit over runs, threads, instruction
# sets, locales and time zones, and over the tools given: built by other compilers, for debugging, in another
# folder. Left out are seconds, dates, the number of threads, and what a build says of itself. Prints the table of
# docs/reports/reliability.md; exit 1 where something differs.
set -uo pipefail
tests=$(cd "$(dirname "$0")" && pwd)
tools=()
for tool in "$@"; do tools+=("$(realpath "$tool")"); done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
ln -s "$tests/data" data
printf '0.25,0.5\n0.123456789,0.987654321\n-3,7\n' >uv.csv

# Each with the tool $T and with $N threads.
all=position,dpdu,dpdv,d2pdu2,d2pduv,d2pdv2,tangent,bitangent,normal,tangent4
all+=,gaussian_curvature,principal_curvatures,christoffel
eval_numbers() {
  for surface in $("$T" surfaces --json | sed -nE 's/^      "name": "(.*)",/\1/p'); do
    "$T" eval "$surface" --grid 24x16 --format f64 --attributes $all --threads "$N"
  done
}
eval_text() {
  "$T" eval torus --input uv.csv --format csv --attributes position,tangent,normal --threads "$N"
  "$T" eval ellipsoid:semi_axis_x=3 --grid 4x4 --json --threads "$N"
}
mesh() { "$T" mesh torus --grid 48x24 -o o.glb && cat o.glb; }
tangents() {
  for method in mikktspace face average unit area angle max; do
    "$T" tangents data/torus_016.none.glb --method $method -o o.glb --quiet --threads "$N" >summary && cat o.glb
  done
}
validate() {
  "$T" validate data/torus_032.three.glb data/sphere_032.mikk.glb data/cone_016.three.glb data/torus_016.obj \
    --json --threads "$N"
}
fit() { "$T" fit data/torus_points.xyz --json --frames f.csv --threads "$N" && cat f.csv; }
converge() {
  "$T" converge --surfaces torus --meshes regular,jittered --resolutions 8..32 --json --threads "$N"
}
compare() { "$T" compare data/torus_032.three.glb data/torus_032.mikk.glb --json --threads "$N"; }
plan() { "$T" plan data/torus_016.three.glb --json --threads "$N"; }
scene() { "$T" scene "$tests/../docs/examples/scene.json" --json; }
commands=(eval_numbers eval_text mesh tangents validate fit converge compare plan scene)

of_the_run='seconds|_ms|_ns|per_s|date|time|started|host|machine|compiler|commit|version|build'
of_the_run="\"(threads|[a-z_]*($of_the_run)[a-z_]*)\": (\[[^]]*\]|\{[^}]*\}|\"[^\"]*\"|[^],}\n]*)"
failed=0
# sums TOOL [VARIABLE=VALUE ...]: a line for each command. What it says on stderr, and a status above 1, is a
# failure.
sums() {
  local command status
  for command in "${commands[@]}"; do
    rm -f o.glb f.csv
    (
      T=$1
      shift
      for variable in "$@"; do export "${variable?}"; done
      "$command" 2>err
    ) >out
    status=$?
    sed -zE "s/$of_the_run//g" out | sha256sum | cut -c1-16
    # 1 is a verdict: the checks of some files do not hold.
    if [ -s err ] || [ $status -gt 1 ]; then
      echo "FAILED: $command: status $status: $(head -1 err)" >&2
      failed=1
    fi
  done
}
rows=()
variant() {  # variant NAME TOOL [VARIABLE=VALUE ...]
  local row="| $1 |" i=0 name=$1
  shift
  sums "$@" >got
  while read -r expected && read -r other <&3; do
    if [ "$expected" = "$other" ]; then row+=" = |"; else
      row+=" **≠** |"
      failed=1
      echo "FAILED: ${commands[$i]}: other bits: $name" >&2
    fi
    i=$((i + 1))
  done <first 3<got
  rows+=("$row")
}
N=1
sums "${tools[0]}" >first
if [ "$(sort -u first | wc -l)" != "${#commands[@]}" ]; then
  echo "FAILED: two commands wrote the same: $(tr '\n' ' ' <first)" >&2
  exit 1
fi
variant "another run" "${tools[0]}"
for N in 2 3 7; do variant "$N threads" "${tools[0]}"; done
N=1
for set in baseline avx2 avx512; do
  if DARBOUX_ISA=$set "${tools[0]}" eval sphere --at 0,0 >/dev/null 2>&1; then
    variant "instructions: $set" "${tools[0]}" DARBOUX_ISA=$set
  else
    echo "SKIPPED: this machine has no $set"
  fi
done
# A locale whose decimals have a comma: one of the machine's, or made here.
comma=$(locale -a 2>/dev/null | grep -iE '^(de|fr|es|it|pt|ru|sv)_' | head -1)
if [ -z "$comma" ] && localedef -i de_DE -f UTF-8 ./de_DE.UTF-8 2>/dev/null; then
  comma=de_DE.UTF-8
  export LOCPATH=$work
fi
if [ -n "$comma" ]; then
  variant "locale $comma" "${tools[0]}" LC_ALL="$comma" LANG="$comma"
else
  echo "SKIPPED: there is no locale with decimal commas"
fi
variant "time zone Asia/Kathmandu" "${tools[0]}" TZ=Asia/Kathmandu
for tool in "${tools[@]:1}"; do variant "$tool" "$tool"; done
echo "|  |$(printf ' %s |' "${commands[@]}")"
echo "|---|$(printf -- '---|%.0s' "${commands[@]}")"
printf '%s\n' "${rows[@]}"
exit $failed
