#!/usr/bin/env bash
# check_deb.sh BUILD WORK COMPILER SOURCE: the Debian packages of a build, unpacked into an empty root: the tool runs there,
# a program builds against the headers, dependencies are named. Exit status 77, a skip, without dpkg-deb or dpkg-shlibdeps.
set -euo pipefail
build=$1 work=$2 compiler=$3 source=$4
for tool in dpkg-deb dpkg-shlibdeps; do
  command -v $tool >/dev/null || { echo "SKIPPED: $tool is not installed"; exit 77; }
done
rm -rf "$work" && mkdir -p "$work/root"
(cd "$work" && cpack --config "$build/CPackConfig.cmake" -B "$work" >cpack.log 2>&1) || { cat "$work/cpack.log" >&2; exit 1; }
shopt -s nullglob
packages=("$work"/*.deb)
[ ${#packages[@]} -ge 2 ] || { echo "FAILED: expected packages of headers and tool, got ${packages[*]-none}" >&2; exit 1; }
for package in "${packages[@]}"; do
  dpkg-deb -x "$package" "$work/root"
  echo "$(basename "$package"): $(dpkg-deb -f "$package" Depends)"
done
libraries=$(dirname "$(find "$work/root/usr" -name 'libdarboux.*' | head -1)")
export LD_LIBRARY_PATH=$libraries
"$work/root/usr/bin/darboux" --version
"$work/root/usr/bin/darboux" eval torus --at 0.3,0.7 >/dev/null
[[ $(dpkg-deb -f "$work"/darboux_*.deb Depends) == *libassimp* ]]
[[ $(dpkg-deb -f "$work"/libdarboux-dev_*.deb Depends) == *libeigen3-dev* ]]
"$compiler" -std=c++20 -ffp-contract=off "$source" -I"$work/root/usr/include" -isystem /usr/include/eigen3 -L"$libraries" \
  -ldarboux -ltbb -o "$work/program"
"$work/program" | grep -q "handedness +1"
