#!/usr/bin/env bash
# check_plan.sh TOOL WORK: whether `TOOL plan` and the Khronos validator agree which tangents are needed, idle and missing. Exit
# status 77, a skip, where node or the validator cannot be had.
set -euo pipefail
tool=$1 work=$2
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../support/npm.sh"
unchecked="the rules of plan are not compared with the validator's"
need_npm "$work" gltf-validator@2.0.0-dev.3.10
rm -rf "$work/files"
mkdir -p "$work/files"
node "$here/compare_plan.js" "$tool" "$work/files"
