#!/bin/bash
# look_at_report.sh TOOL [SCREENSHOT.png]: runs `TOOL converge`, opens its page in headless chromium and asserts that
# both pictures are drawn with their lines, that the table has a row for every study, that no script failed, and that
# the page names nothing outside itself. Exit status 77 where chromium is not installed.
set -euo pipefail
tool=$1 screenshot=${2:-}

fail() { echo "FAILED: $*" >&2; exit 1; }

browser=$(command -v chromium || command -v chromium-browser) || { echo "SKIPPED: chromium not found"; exit 77; }

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
page=$folder/report.html

# A folder with what HTML and the shell give a meaning to: it comes back in the page's command line.
awkward="$folder/it's <b>&\"\$here\""
mkdir "$awkward"
"$tool" converge --surfaces torus:major_radius=1,minor_radius=0.4 --surfaces 'sphere;cylinder' \
  --methods face,average,angle --meshes regular,sheared --resolutions 4..16 --v-range 0.2,0.8 --seed 7 \
  -o "$awkward/report.html" --csv "$folder/report.csv" --json >"$folder/report.json" ||
  fail "the tool ended with status $?"
mv "$awkward/report.html" "$page"

look() {  # look ARGUMENT...: chromium on the page
  timeout 120 "$browser" --headless --no-sandbox --disable-gpu --disable-quic --no-first-run \
    --disable-background-networking --disable-component-update --disable-sync --user-data-dir="$folder/profile" \
    --window-size=1280,1500 "$@" "file://$page" 2>"$folder/browser.log" ||
    { cat "$folder/browser.log" >&2; fail "chromium ended with status $?"; }
}
look --dump-dom >"$folder/dom.html"

count() { grep -o -- "$1" "$2" | wc -l; }
body=$(grep -o -m 1 '<body[^>]*>' "$folder/dom.html")
studies=$(count '"verdict"' "$folder/report.json")
rows=$(count '<tr class="study"' "$folder/dom.html")
echo "studies $studies, rows $rows, $body"

[[ $body != *data-error* ]] || fail "a script failed: $body"
[[ $body == *'data-charts="2"'* ]] || fail "not both pictures are drawn: $body"
# The torus's regular mesh comes first: face and average have an order there, angle is at the floor.
[[ $body == *'data-lines="2"'* ]] || fail "not two lines are drawn: $body"
[[ $studies -gt 0 && $rows == "$studies" ]] || fail "$rows rows for $studies studies"
(($(wc -l <"$folder/report.csv") == 3 * studies + 1)) || fail "the CSV has not one row a study and resolution"
grep -q 'nothing but rounding.*angle' "$folder/dom.html" || fail "the page does not say that angle is at the floor"
grep -qF '&lt;b&gt;&amp;' "$folder/dom.html" || fail "the command line is not escaped"
grep -q '<b>&' "$folder/dom.html" && fail "the command line is markup"
grep -Eq '<(script|link|img|iframe)[^>]*(src|href)="?(https?:)?//' "$page" && fail "the page needs a network"

if [[ -n $screenshot ]]; then look --screenshot="$screenshot" >/dev/null; fi
echo "passed"
