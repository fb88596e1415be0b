#!/usr/bin/env bash
# check_oracle.sh WRITER STORED WORK: whether the npm package mikktspace gives the tangents that are stored for the meshes of
# generated_meshes.h. Exit status 77, a skip, where node or the package cannot be had.
set -euo pipefail
writer=$1 stored=$2 work=$3
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../../support/npm.sh"
unchecked="the stored tangents alone are compared with"
need_npm "$work" mikktspace@1.1.1
"$writer" "$work/meshes"
node "$here/oracle.js" "$work/meshes" "$work/tangents"
cmp "$work/tangents" "$stored"
