#!/usr/bin/env bash
# check_study.sh TOOL WORK: whether docs/schemas/converge-study.schema.json permits what `TOOL converge --study` reads and refuses
# what it refuses, and docs/schemas/results.schema.json permits what it writes. Exit status 77, a skip, where node or ajv
# cannot be had.
set -euo pipefail
tool=$1 work=$2
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../support/npm.sh"
unchecked="the schemas of studies are not held"
need_npm "$work" ajv@6.12.6
rm -rf "$work/files"
mkdir -p "$work/files"
node "$here/check_study.js" "$tool" "$here/../../docs" "$work/files"
