#!/usr/bin/env bash
# surface_snippets.sh PAGES OUTPUT: writes a program with the C++ lines of all pages in the folder PAGES. It fails unless
# each page's surface has the frame that the catalogue's surface of that name with default parameters has.
set -euo pipefail
export LC_ALL=C
pages=$1 output=$2

code() { sed -n '/^```cpp$/,/^```$/{/^```/!p}' "$1"; }
{
  for page in "$pages"/*.md; do code "$page" | grep '^#include' || true; done | sort -u
  printf '#include <darboux/any_surface.h>\n#include <cstdio>\n\n'
  checks="" count=0
  for page in "$pages"/*.md; do
    [[ $(basename "$page") != README.md ]] || continue
    name=$(basename "$page" .md)
    printf 'namespace page_%s {\n%s\n}\n' "${name//-/_}" "$(code "$page" | grep -v '^#include')"
    checks+="  check(\"$name\", page_${name//-/_}::f);"$'\n'
    count=$((count + 1))
  done
  ((count > 0)) || { echo "FAILED: no pages in $pages" >&2; exit 1; }
  cat <<PROGRAM

static int failures = 0;
static void check(const char* name, const darboux::Frame<double>& f) {
  const darboux::Frame<double> g = darboux::make_surface(name).frame(0.3, 0.7);
  if (f.t == g.t && f.b == g.b && f.n == g.n && f.handedness == g.handedness && f.status == g.status) return;
  std::printf("FAILED: %s: the frame on its page is not the catalogue's\n", name);
  ++failures;
}
int main() {
$checks  std::printf("$count snippets, %d failures\n", failures);
  return failures > 0;
}
PROGRAM
} >"$output"
