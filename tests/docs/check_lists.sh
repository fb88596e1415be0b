#!/usr/bin/env bash
# check_lists.sh SOURCE: every key cited as [Name2001] or [Name2001, sec. 2] in the sources and docs has exactly one
# entry in docs/references.bib; every entry names author, title and year.
set -euo pipefail
export LC_ALL=C
cd "$1"
failures=0
complain() {
  echo "FAILED: $*" >&2
  failures=$((failures + 1))
}

bib=docs/references.bib
entries=$(sed -nE 's/^@[a-z]+\{([^,]+),.*/\1/p' "$bib")
cited=$(grep -rhoE '\[[A-Za-z]+[0-9]{4}(,[^]]*)?\]' --include='*.h' --include='*.cpp' --include='*.md' \
  include surfaces src docs | sed -E 's/^\[([A-Za-z]+[0-9]{4}).*/\1/' | sort -u)
[[ -n $cited ]] || complain "no citation was found: is the pattern still right?"
for key in $cited; do
  grep -qx "$key" <<<"$entries" || complain "$key is cited but has no entry in $bib"
done
for key in $(sort <<<"$entries" | uniq -d); do complain "$key has more than one entry in $bib"; done
for key in $entries; do
  entry=$(awk -v key="$key" 'index($0, "{" key ",") {on = 1} on {print} on && /^}/ {exit}' "$bib")
  for field in author title year; do
    grep -qE "^ *$field *=" <<<"$entry" || complain "$key has no $field in $bib"
  done
done

echo "$(wc -w <<<"$cited") keys cited, $(wc -w <<<"$entries") entries"
echo "$failures failures"
exit $((failures > 0))
