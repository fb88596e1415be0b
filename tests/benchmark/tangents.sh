#!/usr/bin/env bash
# tangents.sh [TOOL]: times `darboux tangents` on an indexed torus of 10^6 triangles, a GLB of 36 MB, beside a copy of the file that
# goes to the disk as well; best and median of seven, in turns, and the most memory; then what is asked, as rows of a table. Needs
# GNU time. A quarter of a minute.
set -euo pipefail
cd "$(dirname "$0")/../.."
tool=${1:-build/release/bin/darboux}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$tool" mesh torus --grid 1000x500 -o "$work/in.glb" --quiet
for round in 1 2 3 4 5 6 7; do
  /usr/bin/time -a -o "$work/tangents" -f '%e %U %S %M' "$tool" tangents "$work/in.glb" -o "$work/out.glb" --quiet
  /usr/bin/time -a -o "$work/copy" -f '%e %U %S %M' dd if="$work/in.glb" of="$work/copy.glb" bs=1M conv=fsync status=none
done
size=$(stat -c %s "$work/in.glb")
for what in tangents copy; do
  sort -n "$work/$what" | awk -v what="$what" -v size="$size" '
    { wall[NR] = $1; if (NR == 1 || $2 + $3 < cpu) cpu = $2 + $3; if ($4 > most) most = $4 }
    END { printf "%s: %.2f s best, %.2f s median, %.2f s of processor at best, %.0f MB, %.1f times the file\n",
                 what, wall[1], wall[4], cpu, most * 1024 / 1e6, most * 1024 / size }'
done
echo "| what | required | measured | |"
echo "|---|---|---:|---|"
sort -n "$work/tangents" | awk -v size="$size" '
  function row(what, required, measured, most, unit) {
    printf "| %s | %s | %.2f%s | %s |\n", what, required, measured, unit, measured <= most ? "met" : "**missed**"
  }
  { wall[NR] = $1; if ($4 > memory) memory = $4 }
  END {
    row("`darboux tangents`, 10^6 triangles, median", "<= 1 s", wall[4], 1, " s")
    row("its memory", "<= 2.5 × the file", memory * 1024 / size, 2.5, "")
  }'
