#!/usr/bin/env bash
# check_tidy.sh BUILD [FILE...]: clang-tidy by .clang-tidy over sources of the project, all of src unless files are named. BUILD holds
# compile_commands.json. Exit status 77, a skip, without clang-tidy. All of src takes half an hour of one core.
set -euo pipefail
build=$1
shift
command -v clang-tidy >/dev/null || { echo "SKIPPED: clang-tidy is not installed"; exit 77; }
cd "$(dirname "$0")/../.."
if [ $# -eq 0 ]; then
  mapfile -t files < <(git ls-files 'src/*.cpp' | grep -vE 'evaluate/kernels/baseline_avx2_avx512|local_jets/uv_jets\.cpp')
else
  files=("$@")
fi
printf '%s\n' "${files[@]}" |
  xargs -P "$(nproc)" -n 1 clang-tidy --quiet -p "$build" --extra-arg=-Wno-unknown-warning-option --extra-arg=-Wno-everything
echo "${#files[@]} files are clean"
