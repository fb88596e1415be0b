#!/usr/bin/env bash
# follow_howto.sh SOURCE FOLDER
#
# Does what docs/howto/add-a-surface.md says under "Into the catalogue", to the letter: the type of its program goes into
# a header of its own, its #include and its name into a copy of catalogue.h, which is cut to the first surface and the
# last: all of them compile in half a minute and show no more. Both land in FOLDER/darboux.
set -euo pipefail
howto=$1/docs/howto/add-a-surface.md
folder=$2/darboux
mkdir -p "$folder"
header=$folder/plucker_conoid.h

{
  printf '#pragma once\n\n#include <darboux/surface.h>\n\nnamespace darboux {\n\n'
  # From the type's comment to the line before main.
  awk '
    /^```cpp$/ { block = 1; next }
    /^```$/ { block = 0; type = 0 }
    block && /^\/\/\/ Pl/ { type = 1 }
    /^int main/ { type = 0 }
    type' "$howto"
  printf '}  // namespace darboux\n'
} >"$header"
grep -q 'struct PluckerConoid' "$header" || {
  echo "follow_howto.sh: $howto shows no struct PluckerConoid before its main" >&2
  exit 1
}
sed -e '0,/^#include/s//#include <darboux\/plucker_conoid.h>\n#include/' \
  -e 's/using Catalogue = SurfaceList</&PluckerConoid<>, /' \
  -e '/^using Catalogue = /,/>>;$/{/^using Catalogue = /!{/>>;$/!d}}' "$1/surfaces/darboux/catalogue.h" >"$folder/catalogue.h"
cat >"$2/main.cpp" <<'END'
// The catalogue with one surface more knows it by name, and its laws hold.
#include <cstdio>

#include <darboux/testing.h>

int main() {
  const darboux::AnySurface surface = darboux::make_surface("plucker-conoid:radius=2");
  const std::string broken = darboux::broken_laws(surface);
  std::printf("%s of %zu surfaces\n%s", surface.specification().c_str(), darboux::all_surfaces().size(), broken.c_str());
  return broken.empty() ? 0 : 1;
}
END
