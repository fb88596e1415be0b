#!/usr/bin/env bash
# check_compile_errors.sh COMPILER SOURCE_ROOT: what a compiler says, in one line that names the mend, of an old standard, of options
# that break exact range reduction, and of a surface that lacks a member; and that frames are right under such options where
# clang says nothing of them.
set -euo pipefail
compiler=$1 root=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0
headers=(-I"$root/include" -I"$root/surfaces" -isystem /usr/include/eigen3)
# expect NAME STANDARD ERRORS PATTERN OPTION...: of $work/NAME.cpp there are at most ERRORS errors, and one has the pattern.
expect() {
  if "$compiler" -std="$2" "${@:5}" -fsyntax-only "${headers[@]}" "$work/$1.cpp" >"$work/text" 2>"$work/out"; then
    echo "FAILED: $1 compiles" >&2
    failures=$((failures + 1))
  elif ! grep -E "error" "$work/out" | grep -q "$4" || [ "$(grep -cE '(^|[: ])(fatal )?error:' "$work/out")" -gt "$3" ]; then
    echo "FAILED: $1: expected at most $3 errors and '$4', got" >&2
    head -c 3000 "$work/out" >&2
    failures=$((failures + 1))
  fi
}
printf '#include <darboux/evaluate.h>\n#include <darboux/torus.h>\nint main() {}\n' >"$work/old_standard.cpp"
expect old_standard c++17 2 "Darboux needs C++20"

expect old_standard c++20 1 "expected no -ffast-math" -ffast-math
# The preprocessor refuses, which is faster.
expect old_standard c++20 1 "expected no -ffast-math" -ffinite-math-only -E
reorder=(-fassociative-math -fno-signed-zeros -fno-trapping-math)
if ! "$compiler" --version | grep -q clang; then
  expect old_standard c++20 1 "expected no -ffast-math" -funsafe-math-optimizations -E
  expect old_standard c++20 1 "expected no -ffast-math" "${reorder[@]}" -E
fi
if clang=$(command -v clang++); then
  for options in -O1 "-O2 ${reorder[*]}" "-O3 -funsafe-math-optimizations"; do
    # shellcheck disable=SC2086
    "$clang" -std=c++20 $options -I"$root/include" -I"$root/surfaces" -isystem /usr/include/eigen3 \
      -DNDEBUG "$root/tests/package/unsafe_math.cpp" -o "$work/unsafe_math"
    "$work/unsafe_math" || { echo "FAILED: clang++ $options" >&2; failures=$((failures + 1)); }
  done
else
  echo "clang++ is not there: what its -fassociative-math does is not checked"
fi

# GCC reads the headers of Eigen once.
printf '#include <Eigen/%s>\n' Core Geometry LU SVD >"$work/all.h"
if ! "$compiler" --version | grep -q clang; then
  "$compiler" -std=c++20 "${headers[@]}" -x c++-header "$work/all.h" -o "$work/all.h.gch"
  headers+=(-include "$work/all.h" -Winvalid-pch -Werror=invalid-pch)
fi

body='int main() { frame(Mine{}, 0.1, 0.2); }'
cat >"$work/no_info.cpp" <<END
#include <darboux/evaluate.h>
struct Mine {
  template <class S> darboux::Jet2<S> jet(const S&, const S&) const { return {}; }
};
using darboux::frame;
$body
END
expect no_info c++20 2 "static constexpr SurfaceInfo info"
cat >"$work/no_jet.cpp" <<END
#include <darboux/evaluate.h>
struct Mine {
  static constexpr darboux::SurfaceInfo info{"mine", "a surface", darboux::Coordinate::linear,
                                             darboux::Coordinate::linear};
};
using darboux::frame;
$body
END
expect no_jet c++20 2 "jet(u, v)"
cat >"$work/one_scalar.cpp" <<END
#include <darboux/evaluate.h>
#include <darboux/from_position.h>
struct Mine {
  static constexpr darboux::SurfaceInfo info{"mine", "a surface", darboux::Coordinate::linear,
                                             darboux::Coordinate::linear};
  darboux::Vec3<double> position(double u, double v) const { return {u, v, u * v}; }
};
int main() { frame(darboux::FromPosition<Mine>{}, 0.1, 0.2); }
END
expect one_scalar c++20 2 "expected template <class S> position(u, v) of any scalar"
cat >"$work/double_jet.cpp" <<END
#include <darboux/any_surface.h>
struct Mine {
  static constexpr darboux::SurfaceInfo info{"mine", "a surface", darboux::Coordinate::linear,
                                             darboux::Coordinate::linear};
  darboux::Jet2<double> jet(double, double) const { return {}; }
};
int main() { darboux::AnySurface(Mine{}); }
END
expect double_jet c++20 9 "expected template <class S> jet(u, v) of any scalar"
cat >"$work/float_batch.cpp" <<END
#include <darboux/evaluate.h>
struct Mine {
  static constexpr darboux::SurfaceInfo info{"mine", "a surface", darboux::Coordinate::linear,
                                             darboux::Coordinate::linear};
  darboux::Jet2<double> jet(double u, double v) const { return {{u, v, 0}, {1, 0, 0}, {0, 1, 0}, {}, {}, {}}; }
};
int main() { evaluate(Mine{}, darboux::Points<float>::grid(2, 2), darboux::Outputs<float>{}); }
END
expect float_batch c++20 9 "got one that does not take float"
cat >"$work/curvature_of_doubles.cpp" <<END
#include <darboux/curvature.h>
struct Mine {
  static constexpr darboux::SurfaceInfo info{"mine", "a surface", darboux::Coordinate::linear,
                                             darboux::Coordinate::linear};
  darboux::Jet2<double> jet(double u, double v) const { return {{u, v, 0}, {1, 0, 0}, {0, 1, 0}, {}, {}, {}}; }
};
int main() { darboux::curvature(Mine{}, 0.1, 0.2); }
END
expect curvature_of_doubles c++20 1 "got one that does not take dual numbers"
printf '#include <darboux/evaluate.h>\ndarboux::Points<long double> points;\n' >"$work/long_points.cpp"
expect long_points c++20 1 "expected Points of float or double"
printf '#include <darboux/evaluate.h>\ndarboux::Outputs<long double> outputs;\n' >"$work/long_outputs.cpp"
expect long_outputs c++20 1 "expected Outputs of float or double"
printf '#include <darboux/any_surface.h>\nint main() { frame(darboux::make_surface("torus"), 0.1, 0.2); }\n' >"$work/any_frame.cpp"
expect any_frame c++20 2 "as surface.frame(u, v)"
exit $((failures > 0))
