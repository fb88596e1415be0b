#!/usr/bin/env bash
# schedulers.sh TOOL: the commands of docs/howto/run-a-study.md for GNU parallel and for Slurm give the numbers of one process.
# What is not installed is skipped, aloud; exit status 77 where nothing is left.
set -euo pipefail
tool=$(realpath "$1")
page=$(cd "$(dirname "$0")/.." && pwd)/docs/howto/run-a-study.md
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export PATH="$work/bin:$PATH"
mkdir "$work/bin"
ln -s "$tool" "$work/bin/darboux"
cd "$work"
# The first block of commands that stands under a heading.
block() { awk -v heading="## $1" '$0 == heading {on = 1} on && /^```$/ {exit} inside {print} on && /^```sh$/ {inside = 1}' "$page"; }
# All of a results file that does not depend on the time, the process or the order.
samples() { grep '^{"job"' "$1" | sed -E 's/"seconds":[^,]*,//g' | sort; }

awk "/^cat > study.json/ {on = 1; next} /^END/ {exit} on" "$page" >study.json
darboux converge --study study.json --results one.jsonl --quiet >/dev/null
ran=0
try() {  # try HEADING NAME
  block "$1" >commands.sh
  [ -s commands.sh ] || { echo "FAILED: no commands under $1" >&2; exit 1; }
  rm -f merged.jsonl
  bash -euo pipefail commands.sh >log 2>&1 || { cat log >&2; echo "FAILED: $1" >&2; exit 1; }
  cmp <(samples one.jsonl) <(samples merged.jsonl) || { echo "FAILED: $1: other numbers than one process" >&2; exit 1; }
  echo "$1: as one process"
  ran=1
}
if parallel --version 2>/dev/null | grep -q "GNU parallel"; then
  try "With GNU parallel"
else
  echo "SKIPPED: GNU parallel is not installed; its commands are not checked"
fi
if command -v sbatch >/dev/null && timeout 10 scontrol ping 2>/dev/null | grep -q "is UP"; then
  try "With Slurm"
else
  echo "SKIPPED: no Slurm controller answers; its commands are not checked"
fi
[ $ran = 1 ] || exit 77
