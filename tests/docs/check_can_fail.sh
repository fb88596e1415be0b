#!/usr/bin/env bash
# check_can_fail.sh SCRIPTS TOOL_FOLDER: check_docs.sh, check_lists.sh and check_surface_pages.sh pass on a small
# good tree, and fail when one thing in it is wrong.
set -euo pipefail
scripts=$1 tool=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0

# A good tree: one page with every kind of block and link.
good_tree() {
  rm -rf "$work/tree" "$work/examples"
  mkdir -p "$work/tree/docs/howto" "$work/tree/tests/data" "$work/tree/include" "$work/tree/src" "$work/examples"
  mkdir -p "$work/tree/surfaces"
  printf 'int main() {}\n' >"$work/tree/docs/x.cpp"
  printf '#!/bin/sh\necho "$1 0.5 1.5e-07"\n' >"$work/examples/says"
  chmod +x "$work/examples/says"
  printf '# Changes\n' >"$work/tree/CHANGELOG.md"
  printf '/// [Someone2001, sec. 2]\n' >"$work/tree/include/a.h"
  printf '@book{Someone2001,\n  author = {Some One},\n  title = {Some},\n  year = {2001},\n}\n' \
    >"$work/tree/docs/references.bib"
  cat >"$work/tree/README.md" <<'PAGE'
# Title of it

[here](docs/x.cpp) [there](#title-of-it) [away](https://example.org)

<!-- example: docs/x.cpp -->
```cpp
int main() {}
```
<!-- prints: says word -->
```text
word    0.5 2.5e-07
```
<!-- runs -->
```sh
test -d tests/data
darboux --version | sed 's/[0-9.]*$/N/'
```
<!-- output -->
```text
darboux N
```
<!-- runs: exit 2 -->
```sh
darboux nonsense
```
<!-- not run: only people do -->
```sh
false
```
PAGE
}

# expect pass|fail WHAT SCRIPT ARGUMENT...
expect() {
  local wanted=$1 what=$2 result=pass
  shift 2
  bash "$@" >"$work/log" 2>&1 || result=fail
  [[ $result == "$wanted" ]] && return
  echo "FAILED: $what: expected $wanted, got $result" >&2
  cat "$work/log" >&2
  failures=$((failures + 1))
}
docs() { expect "$1" "$2" "$scripts/check_docs.sh" "$work/tree" "$tool" "$work/examples"; }
lists() { expect "$1" "$2" "$scripts/check_lists.sh" "$work/tree"; }

# breaks WHAT SED-EXPRESSION: the page so changed must fail.
breaks() {
  good_tree
  sed -i "$2" "$work/tree/README.md"
  docs fail "$1"
}

good_tree
docs pass "the good tree"
lists pass "the good tree"
breaks "a snippet differs" 's/^int main() {}$/int main() { return 1; }/'
breaks "an example does not exist" 's/example: docs\/x.cpp/example: docs\/y.cpp/'
breaks "a program prints something else" 's/^word    0.5/word    0.6/'
breaks "a command prints something else" 's/^darboux N$/darboux M/'
breaks "a command fails" 's/^test -d tests\/data/test -d nowhere/'
breaks "a command fails before a pipe" 's/^darboux --version/darboux --no-such-flag/'
breaks "a status differs" 's/exit 2/exit 1/'
breaks "a block has no comment" '/not run/d'
breaks "a comment has no block" '/not run/{p;s/.*/some words/}'
breaks "a link names nothing" 's/(docs\/x.cpp)/(docs\/z.cpp)/'
breaks "a link names no heading" 's/(#title-of-it)/(#other)/'
breaks "a block has no end" '$d'

good_tree
printf '/// [Another1999]\n' >>"$work/tree/include/a.h"
lists fail "a key is not in references.bib"
good_tree
sed -i '/year/d' "$work/tree/docs/references.bib"
lists fail "an entry has no year"
good_tree
sed -i 'p' "$work/tree/docs/references.bib"
lists fail "a key has two entries"

# The tool's own pages, and one thing wrong with them.
pages() { expect "$1" "$2" "$scripts/check_surface_pages.sh" "$work/tree" "$tool/darboux"; }
good_pages() {
  good_tree
  "$tool/darboux" surfaces --pages "$work/tree/docs/surfaces" >"$work/log"
}
good_pages
pages pass "pages just written"
sed -i 's/πu/πv/' "$work/tree/docs/surfaces/sphere.md"
pages fail "a page is stale"
good_pages
printf ' ' >>"$work/tree/docs/surfaces/sphere.svg"
pages fail "a picture is stale"
good_pages
rm "$work/tree/docs/surfaces/sphere.md"
pages fail "a page is missing"
good_pages
cp "$work/tree/docs/surfaces/sphere.md" "$work/tree/docs/surfaces/ball.md"
pages fail "a page belongs to no surface"
good_tree
pages fail "there are no pages"

# --update makes a broken page good again.
good_tree
sed -i -e 's/^int main() {}$/int main() { return 1; }/' -e 's/^darboux N$/darboux M/' "$work/tree/README.md"
expect pass "--update" "$scripts/check_docs.sh" "$work/tree" "$tool" "$work/examples" --update
docs pass "the updated tree"

echo "$failures failures"
exit $((failures > 0))
