#!/usr/bin/env bash
# check_schemas.sh TOOL WORK SUBJECT: check_SUBJECT.js, SUBJECT scene, study, stability, work_precision or normalmap: whether a schema of docs/schemas permits what the tool
# reads and refuses what it refuses, and another permits what it writes. Exit status 77, a skip, where node or ajv cannot be had.
set -euo pipefail
tool=$1 work=$2 subject=$3
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../support/npm.sh"
unchecked="the schemas of $subject are not held"
need_npm "$work" ajv@6.12.6
rm -rf "$work/files"
mkdir -p "$work/files"
node "$here/check_$subject.js" "$tool" "$here/../../docs" "$work/files"
