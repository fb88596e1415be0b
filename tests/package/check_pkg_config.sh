#!/usr/bin/env bash
# check_pkg_config.sh INSTALLED COMPILER SOURCE: a program of the installed core builds by what pkg-config says, and runs.
# Exit status 77, a skip, where pkg-config is not installed.
set -euo pipefail
installed=$1 compiler=$2 source=$3
command -v pkg-config >/dev/null || { echo "SKIPPED: pkg-config is not installed"; exit 77; }
folder=$(dirname "$(find "$installed" -name darboux.pc)")
export PKG_CONFIG_PATH=$folder
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
read -ra flags <<<"$(pkg-config --cflags --libs darboux)"
"$compiler" -std=c++20 "$source" "${flags[@]}" -o "$work/program"
LD_LIBRARY_PATH=$(dirname "$folder") "$work/program" | grep -q "handedness +1"
if [ -e "$folder/darboux-io.pc" ]; then
  printf '%s\n' '#include <darboux/io.h>' 'int main() { try { darboux::read_asset("nowhere.glb"); } catch (const darboux::FileError&) { return 0; } return 1; }' \
    >"$work/io.cpp"
  sed -i '1i #include <darboux/error.h>' "$work/io.cpp"
  read -ra flags <<<"$(pkg-config --cflags --libs darboux-io)"
  "$compiler" -std=c++20 "$work/io.cpp" "${flags[@]}" -o "$work/io"
  LD_LIBRARY_PATH=$(dirname "$folder") "$work/io"
fi
# Compiled for another processor than the library: its structs are laid out as the library's.
if [ -e "$folder/darboux-fit.pc" ] && [ -e "$folder/darboux-io.pc" ] && grep -qw avx /proc/cpuinfo; then
  read -ra flags <<<"$(pkg-config --cflags --libs darboux-fit darboux-io)"
  "$compiler" -std=c++20 -mavx "$(dirname "$0")"/consumer/*.cpp "${flags[@]}" -o "$work/avx"
  LD_LIBRARY_PATH=$(dirname "$folder") "$work/avx"
fi
for name in darboux-fit darboux-io; do
  if [ -e "$folder/$name.pc" ]; then pkg-config --print-requires "$name" | grep -qx darboux; fi
done
