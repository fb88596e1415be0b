#!/usr/bin/env bash
# check_scene.sh TOOL WORK: whether docs/schemas/scene.schema.json permits what `TOOL scene` reads and refuses what it refuses, and
# docs/schemas/scene-plan.schema.json permits what it prints. Exit status 77, a skip, where node or ajv cannot be had.
set -euo pipefail
tool=$1 work=$2
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../support/npm.sh"
unchecked="the schemas of scenes are not held"
need_npm "$work" ajv@6.12.6
rm -rf "$work/files"
mkdir -p "$work/files"
node "$here/check_scene.js" "$tool" "$here/../../docs" "$work/files"
