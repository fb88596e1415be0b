#!/usr/bin/env bash
# reports.sh TOOL SOURCE [convergence|stability|work-precision]...: makes docs/reports/NAME.md and its picture docs/pictures/NAME-report.svg of
# SOURCE, all three unless named. RESULTS=FOLDER keeps the samples there, as NAME.jsonl: what is there is not measured again. Times of
# work-precision and of convergence want a machine that does nothing else. Runs from anywhere.
set -euo pipefail
tool=$(realpath "$1") root=$(realpath "$2")
shift 2
(($#)) || set -- convergence stability work-precision
if [[ -n ${RESULTS:-} ]]; then
  mkdir -p "$RESULTS"
  work=$(realpath "$RESULTS")
else
  work=$(mktemp -d)
  trap 'rm -rf "$work"' EXIT
fi
threads=$(nproc)

# report NAME TEXT COMMAND...: the report, its picture behind the first paragraph. The line it was made by names no file of this machine.
report() {
  local name=$1 text=$2
  shift 2
  cd "$work"
  for format in md svg; do
    # 1: something is not as expected, and the report says what.
    "$tool" "$@" --results "$name.jsonl" -o "$name.$format" >/dev/null || (($? == 1))
  done
  awk -v picture="![$text](../pictures/$name-report.svg)" 'NR > 2 && !done && $0 == "" { print ""; print picture; done = 1 } { print }' \
    "$name.md" | sed -E "s/ --results '?$name\.jsonl'? -o '?$name\.md'?//" >"$root/docs/reports/$name.md"
  cp "$name.svg" "$root/docs/pictures/$name-report.svg"
}

for name; do
  case $name in
    convergence)
      report "$name" "A torus coloured by the error of its tangents, beside the fall of that error by every method" \
        converge --preset standard --threads "$threads"
      ;;
    stability)
      report "$name" "Errors of a sphere in roundings, a panel per sweep, a line per route" stability --threads "$threads"
      ;;
    work-precision)
      report "$name" "Run time against error, a panel per surface and mesh, a mark per method" work-precision --preset standard
      ;;
    *)
      echo "reports.sh: expected convergence, stability or work-precision, got $name" >&2
      exit 2
      ;;
  esac
done
