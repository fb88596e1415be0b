#!/usr/bin/env bash
# check_picture.sh SOURCE TOOL [--update]: docs/pictures/convergence.svg is what the command beneath it in the README writes.
set -euo pipefail
root=$1 tool=$(realpath "$2") update=${3:-}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
command=$(sed -n '/darboux converge .*\\$/,/--picture/p' "$root/README.md" | tr -d '\\\n')
[[ $command == *--picture\ convergence.svg ]] || { echo "FAILED: the README has no such command" >&2; exit 1; }
read -ra words <<<"$command"
(cd "$work" && "$tool" "${words[@]:1}" --quiet)
[ -z "$update" ] || cp "$work/convergence.svg" "$root/docs/pictures/"
cmp "$work/convergence.svg" "$root/docs/pictures/convergence.svg"
